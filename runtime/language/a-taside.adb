--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

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

   function Image (T : Task_Id) return String is
   begin
      if T = null then
         return "";
      end if;
      declare
         Thread : constant not null Thread_Id := To_Thread (T);
         Name   : String (1 .. Thread.Name_Length) with Import, Address => Thread.Name;
      begin
         return Name;
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
