--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Buttons;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Touch_Sensors;

package body Driving is

   use NXT;
   use Quantities;

   Joystick_Touch : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);

   procedure Start (This : in out Vehicle) is
   begin
      Speedometer.Start (This.Meter, NXT.Motor_Encoders.Current);
   end Start;

   procedure Measure (This : in out Vehicle) is
      Reading : constant NXT.Motor_Encoders.Reading := NXT.Motor_Encoders.Current;
      Speeds  : Speedometer.Motor_Speeds;
   begin
      Speedometer.Measure (This.Meter, Reading, Speeds);
      for Side in Wheel loop
         This.Now.Wheels (Side).Speed := To_Volts (Speeds (Motor_Of (Side)));
      end loop;
      This.Now.Joystick := Degrees (Reading.Counts (Joystick_Motor));
      This.Now.Battery := NXT.Battery.Voltage;
   end Measure;

   procedure Stop (This : in out Vehicle; Mode : Drive_Mode) is
   begin
      NXT.Motor_Controls.Brake_All;
      for Side in Wheel loop
         This.Now.Wheels (Side).Setpoint := 0.0;
         This.Now.Wheels (Side).Control := 0.0;
      end loop;
      This.Now.Mode := Mode;
   end Stop;

   procedure Begin_Drive (This : in out Vehicle) is
   begin
      for Side in Wheel loop
         Speed_Controller.Initialize (This.Work (Side));
      end loop;
      This.Now.Mode := (case NXT.Buttons.Current_Button is
                           when Left_Button  => Open_Loop,
                           when Right_Button => Step_Response,
                           when others       => Closed_Loop);
   end Begin_Drive;

   procedure Read_Touch_Sensor (This : in out Vehicle) is
      Touched_Now : constant Boolean := NXT.Touch_Sensors.Pressed (Joystick_Touch);
   begin
      if Touched_Now and then not This.Touched then
         if This.Now.Mode = Stopped then
            Begin_Drive (This);
         else
            Stop (This, Stopped);
         end if;
      end if;
      This.Touched := Touched_Now;
   end Read_Touch_Sensor;

   procedure Read_Power_Button (This : in out Vehicle) is
      Held_Now : constant Boolean := NXT.Buttons.Current_Button = Power_Button;
   begin
      if Held_Now and then not This.Power_Held then
         Stop (This, Off);
         NXT.AVR.Power_Down;
      end if;
      This.Power_Held := Held_Now;
   end Read_Power_Button;

   function Battery_Voltage (This : Vehicle) return Volts is
     (Volts (This.Now.Battery) * 0.001);

   function Maximum_Setpoint (This : Vehicle) return Volts is
     (Volts'Max (0.0, Battery_Voltage (This) - Reserve));

   --  Share of the speed that is left to the inner wheel of the turn.
   function Inner_Share (Angle : Degrees) return Volts is
     (if Angle <= Dead_Zone then 1.0
      elsif Angle >= Full_Lock then 0.0
      else Volts (Full_Lock - Angle) * (1.0 / Volts (Full_Lock)));

   procedure Set_Setpoints (This : in out Vehicle) is
      Maximum : constant Volts := Maximum_Setpoint (This);
      Cruise  : constant Volts := Cruise_Share * Maximum;
      Wheels  : Wheel_Pair renames This.Now.Wheels;
   begin
      if This.Now.Mode = Step_Response then
         Wheels (Left).Setpoint := Volts'Min (Step_Setpoint, Maximum);
         Wheels (Right).Setpoint := Wheels (Left).Setpoint;
      else
         Wheels (Left).Setpoint := Cruise * Inner_Share (This.Now.Joystick);
         Wheels (Right).Setpoint := Cruise * Inner_Share (-This.Now.Joystick);
      end if;
   end Set_Setpoints;

   procedure Run_Controller
     (Values : in out Wheel_Values; Work : in out Speed_Controller.Work_Area)
   is
      Outputs : Speed_Controller.External_Outputs;
   begin
      Speed_Controller.Step (Work, (Values.Setpoint, Values.Speed), Outputs);
      Values.Control := Outputs.Corrected_Voltage;
   end Run_Controller;

   procedure Drive_Wheels (This : in out Vehicle) is
      function To_Duty is new NXT.Motor_Controls.To_Duty (Volts);

      Battery : constant Volts := Battery_Voltage (This);
   begin
      Speed_Controller.Parameters.Saturation := Battery;
      Set_Setpoints (This);
      for Side in Wheel loop
         if This.Now.Mode = Open_Loop then
            This.Now.Wheels (Side).Control := This.Now.Wheels (Side).Setpoint;
         else
            Run_Controller (This.Now.Wheels (Side), This.Work (Side));
         end if;
         NXT.Motor_Controls.Drive
           (Motor_Of (Side), To_Duty (This.Now.Wheels (Side).Control, Battery));
      end loop;
   end Drive_Wheels;

   procedure Control (This : in out Vehicle) is
   begin
      Measure (This);
      if NXT.AVR.Data_Available and then This.Now.Mode /= Off then
         Read_Touch_Sensor (This);
         Read_Power_Button (This);
         if This.Now.Mode in Closed_Loop .. Step_Response then
            Drive_Wheels (This);
         end if;
      end if;
   end Control;

   function Current_Status (This : Vehicle) return Status is (This.Now);

end Driving;
