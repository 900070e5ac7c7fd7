--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Display;  use NXT.Display;
with NXT.Shared_State;
with Quantities;
with System;

package body Panel is

   use Driving;
   use Quantities;

   subtype Title is String (1 .. 11);

   function Title_Of (Mode : Drive_Mode) return Title is
     (case Mode is
         when Stopped       => "stopped    ",
         when Closed_Loop   => "closed loop",
         when Open_Loop     => "open loop  ",
         when Step_Response => "step       ",
         when Off           => "off        ");

   package Latest is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   --  Symbols for an observer; the program only writes them

   Setpoint_Left  : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_setpoint_left";
   Setpoint_Right : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_setpoint_right";
   Speed_Left     : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_speed_left";
   Speed_Right    : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_speed_right";
   Control_Left   : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_control_left";
   Control_Right  : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_control_right";
   Running        : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_running";
   Mode           : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_mode";
   Joystick       : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_joystick";
   Battery        : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "vehicle_battery_millivolts";

   procedure Publish (Now : Status) is
   begin
      Setpoint_Left := Now.Wheels (Left).Setpoint;
      Setpoint_Right := Now.Wheels (Right).Setpoint;
      Speed_Left := Now.Wheels (Left).Speed;
      Speed_Right := Now.Wheels (Right).Speed;
      Control_Left := Now.Wheels (Left).Control;
      Control_Right := Now.Wheels (Right).Control;
      Running := Boolean'Pos (Now.Mode in Closed_Loop .. Step_Response);
      Mode := Drive_Mode'Pos (Now.Mode);
      Joystick := Integer (Now.Joystick);
      Battery := Integer (Now.Battery);
      Latest.Set (Now);
   end Publish;

   --  A number with two decimals, right-aligned, at most 99.99.
   procedure Put_Hundredths (Hundredths : Integer) is
      Whole    : constant Natural := abs Hundredths / 100;
      Fraction : constant Natural := abs Hundredths mod 100;
   begin
      if Hundredths >= 0 then
         Put_Noupdate (Whole, Width => 3);
      else
         Put_Noupdate (if Whole < 10 then " -" else "-");
         Put_Noupdate (Whole);
      end if;
      Put_Noupdate ('.');
      Put_Noupdate (Fraction / 10);
      Put_Noupdate (Fraction mod 10);
   end Put_Hundredths;

   procedure Put_Row (Row : Char_Rows; Name : String; Left, Right : Volts) is
   begin
      Set_Pos (0, Row);
      Put_Noupdate (Name);
      Put_Hundredths (Integer (Left * 100.0));
      Put_Hundredths (Integer (Right * 100.0));
   end Put_Row;

   procedure Draw is
      Now : constant Status := Latest.Get;
      One : Wheel_Values renames Now.Wheels (Left);
      Two : Wheel_Values renames Now.Wheels (Right);
   begin
      Clear_Screen_Noupdate;
      Put_Noupdate (Title_Of (Now.Mode));
      Set_Pos (0, 1);
      Put_Noupdate ("volts left right");
      Put_Row (2, "set", One.Setpoint, Two.Setpoint);
      Put_Row (3, "spd", One.Speed, Two.Speed);
      Put_Row (4, "out", One.Control, Two.Control);
      Set_Pos (0, 5);
      Put_Noupdate ("joystick deg");
      Put_Noupdate (Integer (Now.Joystick), Width => 4);
      Set_Pos (0, 6);
      Put_Noupdate ("battery mV");
      Put_Noupdate (Integer (Now.Battery), Width => 6);
      Set_Pos (0, 7);
      Put_Noupdate ("link errors");
      Put_Noupdate (Integer (NXT.AVR.Link_Errors), Width => 5);
      Screen_Update;
   end Draw;

end Panel;
