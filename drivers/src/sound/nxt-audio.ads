--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The loudspeaker. A tone or sample plays in the background; a new one replaces it. Calls return
--  at once. An interrupt prepares 16 samples at a time, about 2,000 times a second for tones.

with Interfaces;  use Interfaces;
with System;

package NXT.Audio with Elaborate_Body is

   procedure Mute;
   procedure Unmute;
   --  Silence the loudspeaker, or let it be heard again. What plays goes on meanwhile. Unmuted at
   --  the start.

   Maximum_Volume : constant := 100;
   subtype Allowed_Volume is Integer range 0 .. Maximum_Volume;

   Tone_Rate : constant := 31_285;
   --  Samples per second of a tone; tones are to stay below half of it.

   procedure Play_Tone (Frequency : Unsigned_32; Interval : Unsigned_32; Volume : Allowed_Volume)
     with Pre => Frequency in 1 .. Tone_Rate / 2 and then Interval <= 100_000;
   --  Frequency in hertz, Interval in milliseconds.

   Maximum_Rate : constant := 22_050;
   Minimum_Rate : constant := 2_000;
   Default_Rate : constant := 8_000;
   subtype Sampling_Rates is Unsigned_32 range Minimum_Rate .. Maximum_Rate;

   procedure Play_Sample
     (Input        : System.Address;
      Input_Length : Unsigned_32;
      Volume       : Allowed_Volume;
      Rate         : Sampling_Rates := Default_Rate);
   --  Input_Length unsigned bytes from Input on, 128 being silence; they are read while they play.
   --  The rate is right to 1.5 per cent.

   procedure Stop;
   --  End what plays.

   function Time_Remaining return Integer;
   --  Milliseconds until the end of what plays, 0 when nothing does.

end NXT.Audio;
