--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Everything that comes from the co-processor, every 2 ms, in symbols for an observer.

with Ada.Real_Time;      use Ada.Real_Time;
with NXT.AVR;
with NXT.Battery;
with NXT.Buttons;
with NXT.Touch_Sensors;  use NXT.Touch_Sensors;

procedure Inputs is

   use NXT;

   Ready   : Integer := 0 with Volatile, Export, Convention => C, External_Name => "ready";
   Touched : Integer := 0 with Volatile, Export, Convention => C, External_Name => "touched";
   Raw_2   : Integer := 0 with Volatile, Export, Convention => C, External_Name => "raw_2";
   Button  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "button";
   Battery : Integer := 0 with Volatile, Export, Convention => C, External_Name => "battery";
   Pack    : Integer := 0 with Volatile, Export, Convention => C, External_Name => "pack";
   Low     : Integer := 0 with Volatile, Export, Convention => C, External_Name => "low";
   Errors  : Integer := -1 with Volatile, Export, Convention => C, External_Name => "errors";

   Bumper : Touch_Sensor (Sensor_1);
   Next   : Time := NXT.AVR.First_Release;
begin
   loop
      Next := Next + NXT.AVR.Period;
      delay until Next;
      Ready := Boolean'Pos (NXT.AVR.Data_Available);
      Touched := Boolean'Pos (Pressed (Bumper));
      Raw_2 := Integer (NXT.AVR.Raw_Input (Sensor_2));
      Button := Button_Id'Pos (NXT.Buttons.Current_Button);
      Battery := Integer (NXT.Battery.Voltage);
      Pack := Boolean'Pos (NXT.Battery.Rechargeable);
      Low := Boolean'Pos (NXT.Battery.Is_Low);
      Errors := Integer (NXT.AVR.Link_Errors);
   end loop;
end Inputs;
