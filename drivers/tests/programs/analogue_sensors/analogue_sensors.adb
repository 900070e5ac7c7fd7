--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A light sensor whose lamp is on in every other half second, calibrated from 100 ms on at the
--  first and at the second, and a sound sensor that changes its mode with the lamp.

with Ada.Real_Time;             use Ada.Real_Time;
with NXT.AVR;
with NXT.Light_Sensors.Ctors;   use NXT.Light_Sensors, NXT.Light_Sensors.Ctors;
with NXT.Sound_Sensors.Ctors;   use NXT.Sound_Sensors, NXT.Sound_Sensors.Ctors;

procedure Analogue_Sensors is

   use NXT;

   Raw_Light  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "raw_light";
   Normalized : Integer := 0 with Volatile, Export, Convention => C, External_Name => "normalized";
   Value      : Integer := 0 with Volatile, Export, Convention => C, External_Name => "value";
   Percent    : Integer := 0 with Volatile, Export, Convention => C, External_Name => "percent";
   Lamp       : Integer := 0 with Volatile, Export, Convention => C, External_Name => "lamp";
   Raw_Sound  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "raw_sound";
   Level      : Integer := 0 with Volatile, Export, Convention => C, External_Name => "level";
   Weighted   : Integer := 0 with Volatile, Export, Convention => C, External_Name => "weighted";

   Eye  : Light_Sensor := Make (Sensor_1, Floodlight_On => False);
   Ear  : Sound_Sensor := Make (Sensor_2, DBA_Mode => False);
   Next : Time := NXT.AVR.First_Release;

   procedure Observe (Periods : Positive) is
   begin
      for Count in 1 .. Periods loop
         Next := Next + Milliseconds (10);
         delay until Next;
         Raw_Light := Integer (NXT.AVR.Raw_Input (Eye.Id));
         Normalized := Eye.Normalized_Light_Value;
         Value := Eye.Light_Value;
         Percent := Eye.Brightness;
         Lamp := Color'Pos (Eye.Floodlight_Color);
         Raw_Sound := Integer (NXT.AVR.Raw_Input (Ear.Id));
         Level := Ear.Sound_Level;
         Weighted := Boolean'Pos (Ear.DBA_Mode);
      end loop;
   end Observe;

begin
   Observe (10);
   Eye.Calibrate_Low;
   Observe (10);
   Eye.Calibrate_High;
   loop
      Observe (30);
      Eye.Enable_Floodlight (not Eye.Floodlight_On);
      if Ear.DBA_Mode then
         Ear.Use_DB_Mode;
      else
         Ear.Use_DBA_Mode;
      end if;
      Observe (20);
   end loop;
end Analogue_Sensors;
