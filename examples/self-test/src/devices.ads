--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors, sensors, display, sound, converter and clocks.

package Devices is

   procedure Measure_Supply;
   --  Battery, port readings, the chip's own converter.

   procedure Measure_Motors;
   --  Each motor that is plugged in turns forwards and backwards.

   procedure Ask_For_Touch;
   --  The person at the brick presses the sensor in port 1, if there is one.

   procedure Measure_Sound;

   procedure Measure_Clocks;
   --  The slow clock, and the frames of the USB host, against the main clock.

end Devices;
