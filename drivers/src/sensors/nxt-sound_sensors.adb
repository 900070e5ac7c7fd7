--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Sound_Sensors is

   Full_Range : constant Integer := Integer (ADC_Value'Last);

   function Id (This : Sound_Sensor) return Sensor_Id is (This.Port);

   function Sound_Level (This : Sound_Sensor) return Integer is
     ((Full_Range - Integer (NXT.AVR.Reading (This.Port))) * 100 / Full_Range);

   procedure Select_Mode (Port : Sensor_Id; Weighted : Boolean) is
   begin
      Set_Pin_State (Port, Digital_0, (if Weighted then Low else High));
      Set_Pin_State (Port, Digital_1, (if Weighted then High else Low));
   end Select_Mode;

   procedure Use_DBA_Mode (This : in out Sound_Sensor) is
   begin
      This.Weighted := True;
      Select_Mode (This.Port, Weighted => True);
   end Use_DBA_Mode;

   procedure Use_DB_Mode (This : in out Sound_Sensor) is
   begin
      This.Weighted := False;
      Select_Mode (This.Port, Weighted => False);
   end Use_DB_Mode;

   function DBA_Mode (This : Sound_Sensor) return Boolean is (This.Weighted);

end NXT.Sound_Sensors;
