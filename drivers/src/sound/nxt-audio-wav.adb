--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements;  use System, System.Storage_Elements;

package body NXT.Audio.Wav is

   --  The four letters of a chunk's name as a little-endian number
   RIFF_Name   : constant := 16#4646_4952#;
   WAVE_Name   : constant := 16#4556_4157#;
   Format_Name : constant := 16#2074_6D66#;
   Data_Name   : constant := 16#6174_6164#;

   Header_Length : constant := 8;
   --  Name and length of a chunk.
   Name_Length   : constant := 4;
   PCM           : constant := 1;

   function Half_Word_At (Place : System.Address) return Unsigned_16 is
      Bytes : array (0 .. 1) of Unsigned_8 with Import, Address => Place;
   begin
      return Unsigned_16 (Bytes (0)) + 256 * Unsigned_16 (Bytes (1));
   end Half_Word_At;

   function Word_At (Place : System.Address) return Unsigned_32 is
     (Unsigned_32 (Half_Word_At (Place)) + 65_536 * Unsigned_32 (Half_Word_At (Place + 2)));

   --  The address of the content of a chunk; chunks have even lengths. Invalid_Format if there is
   --  none up to Stop.
   function Content (Name : Unsigned_32; First, Stop : System.Address) return System.Address is
      Chunk  : System.Address := First;
      Length : Unsigned_32;
   begin
      while Chunk + Header_Length <= Stop loop
         if Word_At (Chunk) = Name then
            return Chunk + Header_Length;
         end if;
         Length := Word_At (Chunk + Name_Length);
         exit when Length > Unsigned_32 (Stop - Chunk);
         Chunk := Chunk + Header_Length + Storage_Offset (Length + Length mod 2);
      end loop;
      raise Invalid_Format with "NXT.Audio.Wav: chunk missing";
   end Content;

   procedure Play (The_File : File; Volume : Allowed_Volume) is
      Start : constant System.Address := The_File'Address;
      First : constant System.Address := Start + Header_Length + Name_Length;
      Stop  : System.Address;
   begin
      if Word_At (Start) /= RIFF_Name or else Word_At (Start + Header_Length) /= WAVE_Name then
         raise Invalid_Format with "NXT.Audio.Wav: no WAVE file";
      end if;
      Stop := Start + Header_Length + Storage_Offset (Word_At (Start + Name_Length));
      declare
         Format : constant System.Address := Content (Format_Name, First, Stop);
         Data   : constant System.Address := Content (Data_Name, First, Stop);
         Rate   : constant Unsigned_32 := Word_At (Format + 4);
      begin
         if Half_Word_At (Format) /= PCM or else Half_Word_At (Format + 2) /= 1
           or else Half_Word_At (Format + 14) /= 8 or else Rate not in Sampling_Rates
         then
            raise Invalid_Format with "NXT.Audio.Wav: not 8-bit mono PCM";
         end if;
         Play_Sample (Data, Word_At (Data - Name_Length), Volume, Rate);
      end;
   end Play;

end NXT.Audio.Wav;
