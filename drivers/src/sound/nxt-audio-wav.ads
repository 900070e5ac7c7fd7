--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Plays sound files that are linked into the program: 8-bit samples of one channel (Multimedia
--  Programming Interface and Data Specifications 1.0, IBM and Microsoft 1991, RIFF WAVE). A file is
--  an imported object whose address is that of the file's first byte:
--
--     Beep : NXT.Audio.Wav.File with Import, Convention => C, External_Name => "beep_wav_start";

package NXT.Audio.Wav is

   type File is limited private;

   procedure Play (The_File : File; Volume : Allowed_Volume);
   --  As Play_Sample. Invalid_Format if the file is of another kind or its rate out of range.

   Invalid_Format : exception;

private

   type File is limited record
      First : Unsigned_8;
   end record;

end NXT.Audio.Wav;
