--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Four tones, each with its frequency on the display while it sounds.

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.AVR;
with NXT.Audio;      use NXT.Audio;
with NXT.Display;    use NXT.Display;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure Loudspeaker is
   Melody : constant array (1 .. 4) of Unsigned_32 := (262, 330, 392, 523);
   Next   : Time := Clock;
begin
   for Note in Melody'Range loop
      Play_Tone (Melody (Note), Interval => 180, Volume => 50);
      Put_At_Noupdate (0, Note - 1, "tone       Hz");
      Set_Pos (5, Note - 1);
      Put (Integer (Melody (Note)), Width => 5);
      Next := Next + Milliseconds (200);
      delay until Next;
   end loop;
   delay until Time_Last;
end Loudspeaker;
