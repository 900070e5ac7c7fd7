--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Sized is

   type Buffer is array (1 .. 500) of Integer;

   Total : Integer := 0 with Volatile;

   Asked : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "asked_bytes";
   --  The attribute of a task

   procedure Fill (Item : in out Buffer) with No_Inline;

   procedure Fill (Item : in out Buffer) is
   begin
      for Element of Item loop
         Element := Total + 1;
      end loop;
   end Fill;

   procedure Use_Stack with No_Inline;

   procedure Use_Stack is
      Local : Buffer;
   begin
      Fill (Local);
      Total := Local (Total + 1);
   end Use_Stack;

   task body Small is
   begin
      Asked := Large'Storage_Size;
      delay until Time_Last;
   end Small;

   task body Large is
   begin
      Use_Stack;
      delay until Time_Last;
   end Large;

   task body Ending is
   begin
      delay until Time_First;
   end Ending;

   task body Typed is
   begin
      delay until Time_Of (0, Milliseconds (Rank));
      delay until Time_Last;
   end Typed;

end Sized;
