--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Controller_Design;
with NXT.AVR;
with NXT.Battery;
with NXT.Light_Sensors;
with NXT.Light_Sensors.Ctors;
with NXT.Motor_Controls;
with NXT.Shared_State;
with NXT.Touch_Sensors;
with Steering;
with System;

package body Following is

   use NXT;

   --  Readings of the paper and of the line under the lamp
   White : constant := 503;
   Black : constant := 865;

   Edge : constant := 0.5;

   Eye     : NXT.Light_Sensors.Light_Sensor :=
     NXT.Light_Sensors.Ctors.Make (Sensor_3, Floodlight_On => True);
   Touch   : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);
   Touched : Boolean := True;

   package Shared is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   Brightness_Seen : Float := 0.0 with
     Volatile, Export, Convention => C, External_Name => "follow_brightness";
   --  For an observer; the program only writes it.

   Now  : Status;
   Work : Steering.Work_Area;

   procedure Start is
   begin
      NXT.Light_Sensors.Enable_Floodlight (Eye, True);
      Steering.Initialize (Work);
   end Start;

   procedure Read_Touch_Sensor is
      Touched_Now : constant Boolean := NXT.Touch_Sensors.Pressed (Touch);
   begin
      if Touched_Now and then not Touched then
         Now.Running := not Now.Running;
         if not Now.Running then
            NXT.Motor_Controls.Brake_All;
         end if;
      end if;
      Touched := Touched_Now;
   end Read_Touch_Sensor;

   function Duty (Volts, Supply : Float) return PWM_Value is
     (if Volts >= Supply then PWM_Value'Last
      elsif Volts <= 0.0 then 0
      else PWM_Value (100.0 * Volts / Supply));

   procedure Drive is
      Supply  : constant Float := Float (NXT.Battery.Voltage) * 0.001;
      Outputs : Steering.External_Outputs;
      Half    : Float;
   begin
      Steering.Step
        (Work, (Wanted_Brightness => Edge, Brightness => Now.Brightness), Outputs);
      Now.Steering := Outputs.Steering;
      Half := Now.Steering * 0.5;
      NXT.Motor_Controls.Drive
        (Motor_B, Duty (Controller_Design.Cruise_Voltage - Half, Supply));
      NXT.Motor_Controls.Drive
        (Motor_C, Duty (Controller_Design.Cruise_Voltage + Half, Supply));
   end Drive;

   procedure Control is
      Raw : Integer;
   begin
      if NXT.AVR.Data_Available then
         Raw := Integer (NXT.AVR.Raw_Input (Sensor_3));
         Now.Brightness := Float (Black - Raw) * (1.0 / Float (Black - White));
         Read_Touch_Sensor;
         if Now.Running then
            Drive;
         end if;
      end if;
      Brightness_Seen := Now.Brightness;
      Shared.Set (Now);
   end Control;

   function Latest return Status is (Shared.Get);

end Following;
