--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The sound sensor of the NXT set, which hears plainly (dB) or weighted as the ear does (dBA).
--  After a change of mode readings are right 0.3 s later. NXT.Sound_Sensors.Ctors makes sensors.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

package NXT.Sound_Sensors is

   type Sound_Sensor (<>) is tagged private;

   function Id (This : Sound_Sensor) return Sensor_Id;

   function Sound_Level (This : Sound_Sensor) return Integer;
   --  Sound pressure in per cent of the converter's range, which it fills to about 87.

   procedure Use_DBA_Mode (This : in out Sound_Sensor);
   procedure Use_DB_Mode (This : in out Sound_Sensor);
   function DBA_Mode (This : Sound_Sensor) return Boolean;

private

   type Sound_Sensor is tagged record
      Port     : Sensor_Id;
      Weighted : Boolean;
   end record;

   procedure Select_Mode (Port : Sensor_Id; Weighted : Boolean);

end NXT.Sound_Sensors;
