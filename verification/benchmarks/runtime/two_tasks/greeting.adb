--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Greeting is

   protected Box with Priority => 12 is
      procedure Put;
      entry Get;
   private
      Full : Boolean := False;
   end Box;

   protected body Box is

      procedure Put is
      begin
         Full := True;
      end Put;

      entry Get when Full is
      begin
         Full := False;
      end Get;

   end Box;

   task body Sender is
      Next : Time := Time_First;
   begin
      loop
         delay until Next;
         Box.Put;
         Next := Next + Milliseconds (500);
      end loop;
   end Sender;

   task body Receiver is
   begin
      loop
         Box.Get;
         Count := Count + 1;
      end loop;
   end Receiver;

end Greeting;
