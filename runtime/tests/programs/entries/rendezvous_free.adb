--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;

package body Rendezvous_Free is

   protected body Mailbox is

      procedure Put (Value : Integer) is
      begin
         Note ('p');
         Content := Value;
         Full := True;
      end Put;

      entry Get (Value : out Integer) when Full is
      begin
         Note ('g');
         Value := Content;
         Full := False;
      end Get;

      function Waiting return Natural is (Get'Count);

   end Mailbox;

   task body Consumer is
      Value : Integer;
   begin
      loop
         Mailbox.Get (Value);
         Received := Received + Value;
         Note (Character'Val (Character'Pos ('0') + Value));
      end loop;
   end Consumer;

   task body Low_Producer is
      Next : Time := Time_Of (0, Milliseconds (10));
   begin
      loop
         delay until Next;
         Note (if Mailbox.Waiting = 1 then 'w' else '-');
         Mailbox.Put (1);
         Note ('l');
         Next := Next + Milliseconds (10);
      end loop;
   end Low_Producer;

   task body High_Producer is
      Next : Time := Time_Of (0, Milliseconds (15));
   begin
      loop
         delay until Next;
         Mailbox.Put (2);
         Note ('h');
         Next := Next + Milliseconds (10);
      end loop;
   end High_Producer;

end Rendezvous_Free;
