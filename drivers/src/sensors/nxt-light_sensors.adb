--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Sensor_Ports;

package body NXT.Light_Sensors is

   function Reading (This : Light_Sensor) return Integer is
     (Integer (NXT.AVR.Reading (This.Port)));

   function Id (This : Light_Sensor) return Sensor_Id is (This.Port);

   function Light_Value (This : Light_Sensor) return Integer is
     (if This.Low = This.High then 0
      else 100 * (Reading (This) - This.Low) / (This.High - This.Low));

   function Brightness (This : Light_Sensor) return Percentage is
     (Integer'Max (Percentage'First, Integer'Min (Percentage'Last, Light_Value (This))));

   function Normalized_Light_Value (This : Light_Sensor) return Integer is
     (Integer (ADC_Value'Last) - Reading (This));

   procedure Calibrate_Low (This : in out Light_Sensor) is
   begin
      This.Low := Reading (This);
   end Calibrate_Low;

   procedure Calibrate_High (This : in out Light_Sensor) is
   begin
      This.High := Reading (This);
   end Calibrate_High;

   procedure Set_Low (This : in out Light_Sensor; Value : Integer) is
   begin
      This.Low := Value;
   end Set_Low;

   procedure Set_High (This : in out Light_Sensor; Value : Integer) is
   begin
      This.High := Value;
   end Set_High;

   function Get_Low (This : Light_Sensor) return Integer is (This.Low);

   function Get_High (This : Light_Sensor) return Integer is (This.High);

   procedure Enable_Floodlight (This : in out Light_Sensor; Enabled : Boolean) is
      use NXT.Sensor_Ports;
   begin
      This.Floodlight := Enabled;
      Set_Pin_State (This.Port, Digital_0, (if Enabled then High else Low));
   end Enable_Floodlight;

   function Floodlight_On (This : Light_Sensor) return Boolean is (This.Floodlight);

   function Floodlight_Color (This : Light_Sensor) return Color is
     (if This.Floodlight then Red else No_Color);

end NXT.Light_Sensors;
