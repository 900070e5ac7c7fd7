--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A consumer waits on an entry that a lower and a higher producer open in turn

package Rendezvous_Free is

   protected Mailbox with Priority => 20 is
      procedure Put (Value : Integer);
      entry Get (Value : out Integer);
      function Waiting return Natural;
   private
      Content : Integer := 0;
      Full    : Boolean := False;
   end Mailbox;

   Received : Integer := 0
     with Volatile, Export, Convention => C, External_Name => "received";

   task Consumer with Priority => 12, Storage_Size => 512;
   task Low_Producer with Priority => 10, Storage_Size => 512;
   task High_Producer with Priority => 14, Storage_Size => 512;

end Rendezvous_Free;
