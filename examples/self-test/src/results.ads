--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The record of the test: JSON lines in memory, sent over USB to whoever asks for them.

package Results is

   procedure Put (Name : String; Value : Integer; Unit : String);
   procedure Put_Thousandths (Name : String; Value : Integer; Unit : String);
   --  Add a measured row. Value of the second is in 1/1000 of the unit.

   procedure Skip (Name : String; Reason : String);
   --  Add a row that was not measured, with the reason.

   procedure Finish (Part : String);
   --  A part of the test is done.

   task Sender with
     Priority     => 1,
     Storage_Size => 1_024;
   --  Every 10 ms: what is recorded and not sent yet. Each packet from the host asks for the
   --  record from its beginning on.

end Results;
