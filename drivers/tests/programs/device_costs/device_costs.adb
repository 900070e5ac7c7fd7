--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  As costs.adb, with the colour sensor, buttons, name, power, watchdog and savings.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Brick_Name;
with NXT.Buttons;
with NXT.Color_Sensors.Ctors;  use NXT.Color_Sensors, NXT.Color_Sensors.Ctors;
with NXT.Parameters;
with NXT.Power;
with NXT.Sensor_Ports;         use NXT.Sensor_Ports;
with NXT.Watchdog;

procedure Device_Costs is

   use NXT;

   Operations : Integer := 13 with
     Volatile, Export, Convention => C, External_Name => "operations";

   package Kept is new NXT.Parameters.Store (Integer, Id => 1, Format => 1);

   Pressed : Button_Id with Volatile;
   Cause   : NXT.Power.Reset_Cause with Volatile;
   Level   : Pin_States with Volatile;
   Count   : ADC_Value;
   Length  : Natural with Volatile;
   Result  : NXT.Parameters.Save_Result;
   Eye     : Color_Sensor := Make (Sensor_1);
   Seen    : Surface;
   Named   : Color with Volatile;
   Status  : Measurement_Status;

   procedure Perform (Operation : Positive) is
   begin
      case Operation is
         when 2      => Pressed := NXT.Buttons.Current_Button;
         when 3      => Cause := NXT.Power.Last_Reset;
         when 4      => NXT.Watchdog.Restart;
         when 5      => Level := Current_State (Sensor_3, Digital_0);
         when 6      => Convert (Sensor_1, Count);
         when 7      => Eye.Measure (Seen, Status);
         when 8      => Named := Color_Of (Seen);
         when 9      => Kept.Save (Operation, Result);
         when 10     => NXT.Brick_Name.Set_Name ("Ravenbrick", Result);
         when 11     => Length := NXT.Brick_Name.Name'Length;
         when 12     => NXT.Power.Reset_At_Brown_Out;
         when others => null;
      end case;
   end Perform;

   Next : Time := NXT.AVR.First_Release + Milliseconds (501);
begin
   NXT.AVR.Await_Data_Available;
   Eye.Measure (Seen, Status);
   for Operation in 1 .. Operations loop
      delay until Next;
      Perform (Operation);
      Next := Next + Milliseconds (100);
   end loop;
   pragma Unreferenced (Pressed, Cause, Level, Count, Length, Result, Named, Status);
   delay until Time_Last;
end Device_Costs;
