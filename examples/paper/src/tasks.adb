--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;        use Ada.Real_Time;
with Controller_Design;    use Controller_Design;
with Live;
with NXT;                  use NXT;
with NXT.AVR;
with NXT.Battery;
with NXT.Buttons;
with NXT.Display;          use NXT.Display;
with NXT.Motor_Encoders;   use NXT.Motor_Encoders;
with NXT.Telemetry;        use NXT.Telemetry;
with NXT.Touch_Sensors;    use NXT.Touch_Sensors;

package body Tasks is

   --  Listing 2 of the paper: the controller's step function, and its inputs and output in volts

   procedure PID;
   pragma Import (C, PID, "functional_step");

   type ExternalInputs_functional is record
      Input_Voltage : Float;
      Real_Voltage  : Float;
   end record;

   Functional_U : ExternalInputs_functional;
   pragma Export (C, Functional_U, "functional_U");

   type ExternalOutputs_functional is record
      correctedvoltage : Float;
   end record;

   Functional_Y : ExternalOutputs_functional;
   pragma Export (C, Functional_Y, "functional_Y");

   --  The state of that one controller. There are two: Control_Speed exchanges it.

   type D_Work_functional is record
      PI_Controller_DSTATE : Float;
   end record;

   Functional_DW : D_Work_functional;
   pragma Import (C, Functional_DW, "functional_DW");

   At_Rest : constant D_Work_functional := (PI_Controller_DSTATE => 0.0);

   --  The vehicle

   type Wheel is (Left, Right);

   Motor_Of : constant array (Wheel) of Motor_Id := (Left => Motor_B, Right => Motor_C);
   Joystick : constant Motor_Id := Motor_A;
   Button   : Touch_Sensor (Sensor_1);

   Reserve      : constant := 2.0;
   Cruise_Share : constant := 0.8;
   --  The largest set-point leaves the controllers Reserve volts below the battery's voltage.

   Dead_Zone : constant := 2;
   Full_Lock : constant := 90;
   --  Degrees of the joystick: between them the inner wheel of a turn slows down in proportion.

   type Wheel_Voltages is array (Wheel) of Float;

   type Vehicle_Status is record
      Running   : Boolean := False;
      Set_Point : Wheel_Voltages := (others => 0.0);
      Speed     : Wheel_Voltages := (others => 0.0);
      Output    : Wheel_Voltages := (others => 0.0);
      Angle     : Integer := 0;
      Supply    : Float := 0.0;
   end record;
   --  Volts, 116 degrees per second each where they stand for a speed; Angle is the joystick's.

   protected Shared is
      pragma Priority (System.Priority'First + 2);
      procedure Set (Now : Vehicle_Status);
      function Get return Vehicle_Status;
   private
      Latest : Vehicle_Status;
   end Shared;

   protected body Shared is
      procedure Set (Now : Vehicle_Status) is
      begin
         Latest := Now;
      end Set;

      function Get return Vehicle_Status is (Latest);
   end Shared;

   --  Of Control_Task alone

   Now         : Vehicle_Status;
   State       : array (Wheel) of D_Work_functional;
   Was_Pressed : Boolean := True;
   Was_Held    : Boolean := True;

   Set_Point_Left, Set_Point_Right : Float := 0.0;
   pragma Export (C, Set_Point_Left, "vehicle_setpoint_left");
   pragma Export (C, Set_Point_Right, "vehicle_setpoint_right");
   --  For an observer of the memory; the program only writes them.

   --  Encoders as they were read before: the last time, or Speed_Window times ago

   type Wheel_Counts is array (Wheel) of Integer;

   type Reading is record
      Counts  : Wheel_Counts;
      Instant : Time;
   end record;

   subtype Reading_Index is Natural range 0 .. Speed_Window - 1;
   Past   : array (Reading_Index) of Reading;
   Oldest : Reading_Index := 0;

   function Read_Encoders return Reading is
      Counts : Wheel_Counts;
   begin
      for Side in Wheel loop
         Counts (Side) := Encoder_Count (Motor_Of (Side));
      end loop;
      return (Counts, Clock);
   end Read_Encoders;

   --  The difference of two readings over the elapsed time.
   procedure Measure_Speeds is
      This    : constant Reading := Read_Encoders;
      That    : Reading renames Past (Oldest);
      Seconds : constant Float :=
        Float ((This.Instant - That.Instant) / Time_Span_Unit) * Time_Unit;
   begin
      for Side in Wheel loop
         Now.Speed (Side) :=
           Float (This.Counts (Side) - That.Counts (Side)) / (Seconds * Speed_Per_Volt);
      end loop;
      That := This;
      Oldest := (Oldest + 1) mod Speed_Window;
   end Measure_Speeds;

   procedure Stop is
   begin
      Now.Running := False;
      Now.Set_Point := (others => 0.0);
      Now.Output := (others => 0.0);
      for Side in Wheel loop
         NXT.AVR.Set_Power (Motor_Of (Side), 0, Brake => True);
      end loop;
   end Stop;

   procedure Check_Joystick is
      Is_Pressed : constant Boolean := Pressed (Button);
   begin
      Now.Angle := Encoder_Count (Joystick);
      if Is_Pressed and then not Was_Pressed then
         if Now.Running then
            Stop;
         else
            State := (others => At_Rest);
            Now.Running := True;
         end if;
      end if;
      Was_Pressed := Is_Pressed;
   end Check_Joystick;

   procedure Check_Power_Button is
      Is_Held : constant Boolean := NXT.Buttons.Current_Button = Power_Button;
   begin
      if Is_Held and then not Was_Held then
         Stop;
         NXT.AVR.Power_Down;
      end if;
      Was_Held := Is_Held;
   end Check_Power_Button;

   --  Share of the speed that a turn by an angle leaves to its inner wheel.
   function Inner_Share (Angle : Integer) return Float is
     (if Angle <= Dead_Zone then 1.0
      elsif Angle >= Full_Lock then 0.0
      else Float (Full_Lock - Angle) / Float (Full_Lock));

   procedure Command_Speeds is
      Maximum : constant Float := Float'Max (0.0, Now.Supply - Reserve);
      Cruise  : constant Float := Float'Min (Cruise_Share * Maximum, Current (Live.Top_Speed));
   begin
      Now.Set_Point :=
        (Left => Cruise * Inner_Share (Now.Angle), Right => Cruise * Inner_Share (-Now.Angle));
   end Command_Speeds;

   --  One step of one of the two controllers.
   procedure Control_Speed (Side : Wheel) is
   begin
      Functional_U := (Now.Set_Point (Side), Now.Speed (Side));
      Functional_DW := State (Side);
      PID;
      State (Side) := Functional_DW;
      Now.Output (Side) := Functional_Y.correctedvoltage;
      NXT.AVR.Set_Power
        (Motor_Of (Side), PWM_Value (100.0 * Now.Output (Side) / Now.Supply), Brake => True);
   end Control_Speed;

   procedure Drive is
   begin
      Command_Speeds;
      Live.Adopt (Battery => Now.Supply);
      Control_Speed (Left);
      Control_Speed (Right);
   end Drive;

   procedure Report is
   begin
      Shared.Set (Now);
      Set_Point_Left := Now.Set_Point (Left);
      Set_Point_Right := Now.Set_Point (Right);
      Publish
        (1,
         (Of_Real (Now.Set_Point (Left)), Of_Real (Now.Set_Point (Right)),
          Of_Real (Now.Speed (Left)), Of_Real (Now.Speed (Right)),
          Of_Real (Now.Output (Left)), Of_Real (Now.Output (Right)),
          Of_Whole (Now.Angle), Of_Whole (Integer (NXT.Battery.Millivolts))));
   end Report;

   First_Release : constant Time := NXT.AVR.First_Release + Milliseconds (100);
   --  An even number of periods of the co-processor task after its own first release: it asks for
   --  inputs then, and sends outputs a period later, by when Control_Task has done its job.

   task body Control_Task is
      Next_Release : Time := First_Release;
   begin
      Past := (others => Read_Encoders);
      loop
         delay until Next_Release;
         Measure_Speeds;
         Now.Supply := Float (NXT.Battery.Millivolts) * 0.001;
         Check_Joystick;
         Check_Power_Button;
         if Now.Running then
            Drive;
         end if;
         Report;
         Next_Release := Next_Release + Milliseconds (Sample_Time_Ms);
      end loop;
   end Control_Task;

   procedure Put_Row (Row : Char_Rows; Name : String; Volts : Wheel_Voltages) is
   begin
      Set_Pos (0, Row);
      Put_Noupdate (Name);
      for Side in Wheel loop
         Put_Noupdate (Integer (1000.0 * Volts (Side)), Width => 6);
      end loop;
   end Put_Row;

   procedure Show (Now : Vehicle_Status) is
   begin
      Clear_Screen_Noupdate;
      Put_Noupdate (if Now.Running then "running" else "stopped");
      Set_Pos (0, 1);
      Put_Noupdate ("mV    left right");
      Put_Row (2, "set ", Now.Set_Point);
      Put_Row (3, "real", Now.Speed);
      Put_Row (4, "out ", Now.Output);
      Set_Pos (0, 5);
      Put_Noupdate ("joystick");
      Put_Noupdate (Now.Angle, Width => 8);
      Set_Pos (0, 6);
      Put_Noupdate ("battery");
      Put_Noupdate (Integer (1000.0 * Now.Supply), Width => 9);
      Screen_Update;
   end Show;

   task body Display_Task is
      Next_Release : Time := First_Release;
   begin
      loop
         delay until Next_Release;
         Show (Shared.Get);
         Next_Release := Next_Release + Milliseconds (500);
      end loop;
   end Display_Task;

end Tasks;
