--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sounds at fixed times: a tone of 440 Hz at 100 ms, a louder one of 5 kHz at 400 ms that is muted
--  for a while, a recorded square wave of 500 Hz at 700 ms, a tone replaced by another at 1 s, the
--  square wave at 12 kHz at 1.5 s. The link to the co-processor goes on beside them.

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.AVR;
pragma Unreferenced (NXT.AVR);
with NXT.Audio;      use NXT.Audio;

procedure Audio is

   Remaining : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "remaining";

   --  Period of 16 samples at 8 kHz
   type Recording is array (Natural range 0 .. 799) of Unsigned_8;
   Square : Recording;

   Start : constant Time := Clock;

   procedure Wait_Until (Instant_Ms : Positive) is
      Next : Time := Clock;
   begin
      while Next < Start + Milliseconds (Instant_Ms) loop
         Remaining := Time_Remaining;
         Next := Next + Milliseconds (1);
         delay until Next;
      end loop;
   end Wait_Until;

begin
   for Place in Square'Range loop
      Square (Place) := (if Place mod 16 < 8 then 228 else 28);
   end loop;
   Wait_Until (100);
   Play_Tone (Frequency => 440, Interval => 200, Volume => 50);
   Wait_Until (400);
   Play_Tone (Frequency => 5_000, Interval => 200, Volume => 100);
   Wait_Until (450);
   Mute;
   Wait_Until (500);
   Unmute;
   Wait_Until (700);
   Play_Sample (Square'Address, Square'Length, Volume => 100);
   Wait_Until (1_000);
   Play_Tone (Frequency => 1_000, Interval => 500, Volume => 100);
   Wait_Until (1_100);
   Play_Tone (Frequency => 2_000, Interval => 100, Volume => 100);
   Wait_Until (1_500);
   Play_Sample (Square'Address, Square'Length, Volume => 100, Rate => 12_000);
   Wait_Until (10_000);
end Audio;
