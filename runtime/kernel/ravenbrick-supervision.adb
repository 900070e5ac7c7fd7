--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Clock;
with Ravenbrick.Failures;
with Ravenbrick.Processor;
with Ravenbrick.Threads; use Ravenbrick.Threads;
with Ravenbrick.Watchdog;

package body Ravenbrick.Supervision is

   use Interfaces;

   type Deadline_Table is array (System.Any_Priority) of Unsigned_32;

   Deadlines : Deadline_Table
     with Import, Volatile, Convention => C, External_Name => "ravenbrick_deadlines";
   --  In units of the clock, zero where no task is declared; odd for sporadic tasks

   Seen_Ready : array (System.Any_Priority) of Unsigned_32 := (others => 0);
   --  The clock's last 32 bits, rounded down to even ones, when a sporadic task was first seen
   --  ready; zero when it was not

   Units_Per_Ms : constant := 21_024;
   Start_Up     : constant := 500 * Units_Per_Ms;

   Longest_Lateness_Ms : constant := 100;
   Weight              : constant := 10;
   --  A period in which a task is late counts as much as ten in which none is

   Lateness : Natural := 0;
   Armed    : Boolean := False;

   Late       : constant String := "deadline missed for 100 ms" & ASCII.NUL;
   Ended      : constant String := "Tasking_Error: task ended" & ASCII.NUL;
   Overflow   : constant String := "Storage_Error: stack overflow" & ASCII.NUL;
   Nobody     : constant String := "main procedure ended, no task left" & ASCII.NUL;
   Started    : constant String := "watchdog reset" & ASCII.NUL;

   procedure Fail (Culprit : not null Thread_Id; Text : System.Address) with No_Return;

   procedure Fail (Culprit : not null Thread_Id; Text : System.Address) is
   begin
      Processor.Mask_In_Thread;
      Kernel.Current := Culprit;
      Failures.Stop (Text);
   end Fail;

   function Stack_Is_Intact (Each : not null Thread_Id) return Boolean is
      Lowest : Unsigned_32
        with Import, Volatile,
             Address => To_Address ((To_Integer (Each.Stack_Base) + 3) / 4 * 4);
   begin
      return Lowest = 0;
   end Stack_Is_Intact;

   function Sporadic_Is_Late
     (Priority : System.Any_Priority; Deadline, Now : Unsigned_32) return Boolean is
   begin
      if Seen_Ready (Priority) = 0 then
         Seen_Ready (Priority) := Now and not 1;
      end if;
      return Now - Seen_Ready (Priority) > Deadline;
   end Sporadic_Is_Late;

   function Is_Late (Each : not null Thread_Id; Now : Units) return Boolean is
      Priority : constant System.Any_Priority := Each.Base_Priority;
      Deadline : constant Unsigned_32 := Deadlines (Priority);
      Low      : constant Unsigned_32 := Unsigned_32'Mod (Now);
   begin
      if Deadline = 0 then
         return False;
      end if;
      case Each.State is
         when Unstarted =>
            return Now > Start_Up;
         when Ready =>
            if (Deadline and 1) /= 0 then
               return Sporadic_Is_Late (Priority, Deadline, Low);
            elsif Each.Wake = 0 then
               return Now > Start_Up;
            else
               return Now - Each.Wake > Units (Deadline);
            end if;
         when Terminated =>
            Fail (Each, Ended'Address);
         when others =>
            Seen_Ready (Priority) := 0;
            return False;
      end case;
   end Is_Late;

   procedure Check (Elapsed_Ms : Positive) is
      Now     : constant Units := Clock.Now;
      Each    : Thread_Id := Kernel.First_Created;
      Culprit : Thread_Id := null;
      Alive   : Natural := 0;
   begin
      if not Enabled then
         return;
      end if;
      if not Armed then
         if Watchdog.Was_Reset then
            Failures.Stop (Started'Address);
         end if;
         Watchdog.Arm;
         Armed := True;
      end if;
      while Each /= null loop
         if not Stack_Is_Intact (Each) then
            Fail (Each, Overflow'Address);
         end if;
         if Is_Late (Each, Now) then
            Culprit := Each;
         end if;
         Alive := Alive + (if Each.State = Terminated then 0 else 1);
         Each := Each.Next_Created;
      end loop;
      if Alive = 1 then
         Fail (Environment'Access, Nobody'Address);
      elsif Culprit = null then
         Lateness := Integer'Max (0, Lateness - Elapsed_Ms);
      elsif Lateness < Weight * Longest_Lateness_Ms then
         Lateness := Lateness + Weight * Elapsed_Ms;
      else
         Fail (Culprit, Late'Address);
      end if;
      Watchdog.Restart;
   end Check;

end Ravenbrick.Supervision;
