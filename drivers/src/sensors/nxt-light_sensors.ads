--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The light sensor of the NXT set, with its red lamp on (reflected light) or off (light of the
--  surroundings). The reading falls with more light; after switching the lamp the reading is right
--  10 ms later. NXT.Light_Sensors.Ctors makes sensors.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

package NXT.Light_Sensors is

   type Light_Sensor (<>) is tagged private;

   function Id (This : Light_Sensor) return Sensor_Id;

   subtype Percentage is Integer range 0 .. 100;

   function Brightness (This : Light_Sensor) return Percentage;
   --  Recommended: Light_Value, limited to its range.

   function Light_Value (This : Light_Sensor) return Integer;
   --  In per cent from the reading at Low to that at High; beyond 0 or 100 outside of them; 0 when
   --  they are equal. Before any calibration these are the ends of the converter's range.

   function Normalized_Light_Value (This : Light_Sensor) return Integer;
   --  1023 less the reading: rises with more light.

   procedure Calibrate_Low (This : in out Light_Sensor);
   procedure Calibrate_High (This : in out Light_Sensor);
   --  Take what is seen now as 0 or 100 per cent. NXT.AVR.Data_Available must be true.

   procedure Set_Low (This : in out Light_Sensor; Value : Integer);
   procedure Set_High (This : in out Light_Sensor; Value : Integer);
   function Get_Low (This : Light_Sensor) return Integer;
   function Get_High (This : Light_Sensor) return Integer;
   --  Readings at 0 and 100 per cent.

   procedure Enable_Floodlight (This : in out Light_Sensor; Enabled : Boolean);
   function Floodlight_On (This : Light_Sensor) return Boolean;

   function Floodlight_Color (This : Light_Sensor) return Color;
   --  Red while the lamp is on, else No_Color.

private

   type Light_Sensor is tagged record
      Port       : Sensor_Id;
      Low        : Integer := Integer (ADC_Value'Last);
      High       : Integer := Integer (ADC_Value'First);
      Floodlight : Boolean;
   end record;

end NXT.Light_Sensors;
