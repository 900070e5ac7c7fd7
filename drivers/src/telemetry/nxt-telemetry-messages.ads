--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Contents of frames as docs/reference/telemetry.md describes them.

with NXT.Bytes;   use NXT.Bytes;
with NXT.Frames;

private package NXT.Telemetry.Messages is

   Protocol_Version : constant := 1;

   --  To the host

   Longest_Message : constant := 8 + 4 * Group_Size;
   --  A sample of a whole group; a parameter has at most 16 + Name_Length + Unit_Length bytes.

   type Builder is record
      Data : Byte_Array (1 .. Longest_Message);
      Last : Natural range 0 .. Longest_Message := 0;
   end record;

   procedure Build_Hello (Into : out Builder; Name : String; Now : Ada.Real_Time.Time);
   procedure Build_Signal (Into : out Builder; Number : Signal_Number);
   procedure Build_Parameter (Into : out Builder; Item : Parameter);
   procedure Build_Sample (Into : out Builder; Slot : Sample_Slot);
   procedure Build_Answer (Into : out Builder; Index : Byte; Value_Bits : Four_Bytes);
   --  The wish to change a parameter is granted or refused here.
   procedure Build_Status (Into : out Builder; Sent : Unsigned_32; Damaged : Natural);
   procedure Build_Refused (Into : out Builder);

   --  From the host

   type Request is (Nothing, Ask, Ask_Other_Version, Set_Parameter, Keep_Alive, Stop);

   function Request_In (Item : Frames.Reader) return Request;
   --  Of the content that Item holds; Nothing when it is not one of this version.

   procedure Read_Set
     (Item : Frames.Reader; Index : out Byte; Value_Bits : out Four_Bytes)
   with Pre => Request_In (Item) = Set_Parameter;

end NXT.Telemetry.Messages;
