--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The colour sensor of the NXT 2.0 set: a phototransistor with a red, a green and a blue lamp. It
--  flashes the three in turn to tell colours, or shines with one of them as a light sensor does.
--  NXT.Color_Sensors.Ctors makes sensors.
--
--  Each operation is to be called by one task at a time; sensors at several ports may be used by
--  several tasks. Nothing polls: the lines are driven by the interrupt of a timer.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

package NXT.Color_Sensors is

   type Color_Sensor (<>) is tagged private;

   type Lamp_Mode is (All_Lamps, Red_Lamp, Green_Lamp, Blue_Lamp, No_Lamp);

   function Id (This : Color_Sensor) return Sensor_Id;

   function Mode (This : Color_Sensor) return Lamp_Mode;

   type Measurement_Status is (Measured, No_Sensor, Wrong_Checksum);
   --  Wrong_Checksum: something answers, but not with a valid calibration.

   procedure Set_Mode
     (This : in out Color_Sensor; Mode : Lamp_Mode; Status : out Measurement_Status);
   --  Reset the sensor into a mode and take its calibration: suspends the caller for 140 ms, or for
   --  nothing when there is no sensor. A sensor that was unplugged or did not answer gets its mode
   --  again with the next measurement, which then takes as long.

   type Intensity is range 0 .. 255;
   --  Corrected by the sensor's calibration: a white surface close to it gives 255.

   type Surface is record
      Red, Green, Blue : Intensity := 0;
      Background       : Intensity := 0;
   end record;
   --  Background: light that is there without lamps.

   procedure Measure
     (This : in out Color_Sensor; Seen : out Surface; Status : out Measurement_Status)
     with Pre => Mode (This) = All_Lamps;
   --  Suspends the caller for 0.8 ms. Seen is dark unless Status is Measured.

   function Color_Of (Seen : Surface) return Color;
   --  The colour that Seen comes closest to: too dark is Black, without colour White. For a surface
   --  some 10 mm away.

   procedure Read_Color
     (This : in out Color_Sensor; Seen : out Color; Status : out Measurement_Status)
     with Pre => Mode (This) = All_Lamps;
   --  Measure and Color_Of; No_Color unless Status is Measured.

   subtype Percentage is Integer range 0 .. 100;

   procedure Measure_Light
     (This : in out Color_Sensor; Level : out Percentage; Status : out Measurement_Status)
     with Pre => Mode (This) /= All_Lamps;
   --  The light that comes back with the lamp of the mode, uncorrected, from darkness to the most
   --  that can be converted. Suspends the caller for 0.3 ms.

private

   type Row is range 0 .. 2;
   type Factors is array (Row, 0 .. 3) of Natural;
   type Limits is array (0 .. 1) of ADC_Value;

   type Color_Sensor is tagged record
      Port    : Sensor_Id;
      Mode    : Lamp_Mode;
      Ready   : Boolean := False;
      Factor  : Factors := (others => (others => 0));
      Limit   : Limits := (others => 0);
   end record;
   --  Factor: in 1/65536, of red, green, blue and background. The row: 2 below Limit (1), 1 below
   --  Limit (0), else 0.

end NXT.Color_Sensors;
