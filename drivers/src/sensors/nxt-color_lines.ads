--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What passes on the two digital lines of colour sensors: a timer's interrupt makes one step each
--  40 us on every port that is busy, and the task that waits is suspended. Protocol: LEGO's
--  published firmware of the NXT, version 1.29, input module.

with NXT.Bytes;  use NXT.Bytes;

private package NXT.Color_Lines is

   subtype Mode_Code is Byte range 13 .. 17;
   --  All lamps in turn; red, green, blue lamp; no lamp.

   subtype Calibration is Byte_Array (1 .. 54);

   procedure Exchange
     (Port : Sensor_Id; Mode : Mode_Code; Received : out Calibration);
   --  Send the mode to a sensor that was reset and take what it answers. Suspends for 36 ms.

   type Lamp is (Off, Red, Green, Blue);
   type Counts is array (Lamp) of ADC_Value;

   procedure Sample
     (Port : Sensor_Id; All_Lamps : Boolean; Result : out Counts; Lost : out Boolean);
   --  Each count is the mean of two; without All_Lamps only that of Off. Lost: nobody holds the
   --  clock. Suspends for 0.8 ms, or 0.3 ms.

end NXT.Color_Lines;
