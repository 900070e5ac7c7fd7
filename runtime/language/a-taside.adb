--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Failures;
with Ravenbrick.Threads;

package body Ada.Task_Identification is

   use Ravenbrick.Threads;

   function To_Thread (T : Task_Id) return not null Thread_Id;
   --  Program_Error for Null_Task_Id (RM C.7.1 (15))

   function To_Thread (T : Task_Id) return not null Thread_Id is
   begin
      if T = null then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Null_Task_Id'Address);
      end if;
      return System.Tasking.To_Thread (System.Tasking.Task_Id (T));
   end To_Thread;

   function Hexadecimal (T : Task_Id) return String;
   --  Eight digits of the address of the control block

   function Hexadecimal (T : Task_Id) return String is
      Hex_Digits : constant String (1 .. 16) := "0123456789ABCDEF";
      Rest       : Unsigned_32 := Unsigned_32 (To_Integer (T.all'Address));
      Text       : String (1 .. 8);
   begin
      for Letter of reverse Text loop
         Letter := Hex_Digits (1 + Natural (Rest mod 16));
         Rest := Rest / 16;
      end loop;
      return Text;
   end Hexadecimal;

   function Image (T : Task_Id) return String is
   begin
      if T = null then
         return "";
      end if;
      declare
         Thread : constant not null Thread_Id := To_Thread (T);
         Name   : String (1 .. Thread.Name_Length) with Import, Address => Thread.Name;
      begin
         return (if Name'Length = 0 then Hexadecimal (T) else Name);
      end;
   end Image;

   function Current_Task return Task_Id is (Task_Id (System.Tasking.Self));

   function Environment_Task return Task_Id is
     (Task_Id (System.Tasking.To_Task (Environment'Access)));

   function Is_Terminated (T : Task_Id) return Boolean is (To_Thread (T).State = Terminated);

   function Is_Callable (T : Task_Id) return Boolean is (To_Thread (T).State /= Terminated);

   function Activation_Is_Complete (T : Task_Id) return Boolean is
     (To_Thread (T).State /= Unstarted);

end Ada.Task_Identification;
