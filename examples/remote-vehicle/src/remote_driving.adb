--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Joystick_Commands;
with NXT.AVR;
with NXT.Battery;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Shared_State;
with Quantities;       use Quantities;
with Speed_Controller;
with Speedometer;
with System;

package body Remote_Driving is

   package Shared is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   use NXT;

   type Wheel is (Left, Right);

   Motor_Of : constant array (Wheel) of Motor_Id := (Left => Motor_B, Right => Motor_C);

   --  Volts; the inner wheel of a turn slows down and stands at Full_Lock
   Cruise    : constant Volts := 4.5;
   Full_Lock : constant := 90;

   type Wheel_Volts is array (Wheel) of Volts;
   type Work_Areas is array (Wheel) of Speed_Controller.Work_Area;

   Meter : Speedometer.Meter;
   Work  : Work_Areas;
   Now   : Status;

   --  Symbols for an observer; the program only writes them

   Setpoint_Left  : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "remote_setpoint_left";
   Setpoint_Right : Volts := 0.0 with
     Volatile, Export, Convention => C, External_Name => "remote_setpoint_right";

   procedure Start is
   begin
      Speedometer.Start (Meter, NXT.Motor_Encoders.Current);
   end Start;

   function Inner_Share (Angle : Integer) return Volts is
     (if Angle <= 0 then 1.0 else Volts (Full_Lock - Angle) * (1.0 / Volts (Full_Lock)));

   procedure Begin_Drive is
   begin
      for Side in Wheel loop
         Speed_Controller.Initialize (Work (Side));
      end loop;
      Now.Driving := True;
   end Begin_Drive;

   procedure Stop is
   begin
      NXT.Motor_Controls.Brake_All;
      Setpoint_Left := 0.0;
      Setpoint_Right := 0.0;
      Now.Driving := False;
   end Stop;

   procedure Drive (Speeds : Speedometer.Motor_Speeds) is
      function To_Duty is new NXT.Motor_Controls.To_Duty (Volts);

      Battery  : constant Volts := Volts (NXT.Battery.Voltage) * 0.001;
      Wanted   : constant Wheel_Volts :=
        (Left  => Cruise * Inner_Share (Now.Angle),
         Right => Cruise * Inner_Share (-Now.Angle));
      Measured : Volts;
      Outputs  : Speed_Controller.External_Outputs;
   begin
      Speed_Controller.Parameters.Saturation := Battery;
      for Side in Wheel loop
         Measured := To_Volts (Speeds (Motor_Of (Side)));
         Speed_Controller.Step (Work (Side), (Wanted (Side), Measured), Outputs);
         NXT.Motor_Controls.Drive
           (Motor_Of (Side), To_Duty (Outputs.Corrected_Voltage, Battery));
      end loop;
      Setpoint_Left := Wanted (Left);
      Setpoint_Right := Wanted (Right);
   end Drive;

   procedure Control is
      Order  : Joystick_Commands.Command;
      Speeds : Speedometer.Motor_Speeds;
   begin
      Speedometer.Measure (Meter, NXT.Motor_Encoders.Current, Speeds);
      Air.Get (Order, Now.Contact);
      Now.Angle := Integer (Order.Angle);
      if not NXT.AVR.Data_Available then
         return;
      elsif Order.Running then
         if not Now.Driving then
            Begin_Drive;
         end if;
         Drive (Speeds);
      elsif Now.Driving then
         Stop;
      end if;
      Shared.Set (Now);
   end Control;

   function Latest return Status is (Shared.Get);

end Remote_Driving;
