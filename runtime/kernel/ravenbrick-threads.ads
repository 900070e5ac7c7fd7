--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Threads, the ready queue and dispatching: preemptive fixed priorities, first in first out
--  within a priority (Ada RM D.2.3).
--
--  Urgency orders everything: twice the priority, plus one inside a protected action. One word
--  thus says whom a thread may be preempted by and whether it may block.

with Interfaces;
with System;
with System.Storage_Elements; use System.Storage_Elements;

package Ravenbrick.Threads is
   pragma Preelaborate;

   type Urgency is range -2 ** 31 .. 2 ** 31 - 1 with Size => 32;

   function To_Urgency (Priority : System.Any_Priority) return Urgency is
     (Urgency (2 * Priority)) with Inline_Always;
   --  Urgency of a thread that is in no protected action

   function To_Protected_Urgency (Priority : System.Any_Priority) return Urgency is
     (Urgency (2 * Priority + 1)) with Inline_Always;
   --  Urgency inside a protected action whose ceiling is Priority

   function In_Protected_Action (Active : Urgency) return Boolean is (Active mod 2 = 1)
     with Inline_Always;
   --  Whether a thread of this urgency must not block (RM 9.5.1)

   First_Interrupt_Urgency : constant := 2 * System.Interrupt_Priority'First;

   type Thread_State is (Unstarted, Ready, Delayed, Suspended, Blocked_On_Entry, Terminated)
     with Size => 32;
   for Thread_State use
     (Unstarted => 0, Ready => 1, Delayed => 2, Suspended => 3, Blocked_On_Entry => 4,
      Terminated => 5);

   type Units is new Interfaces.Integer_64;
   --  Time since the clock was started, in units of 1/21_024_000 s

   type Thread;
   type Thread_Id is access all Thread;

   type Thread is limited record
      Active : Urgency;
      pragma Volatile (Active);

      Secondary_Stack : System.Address;

      Stack_Pointer : System.Address;
      --  While the thread does not run; it points to the address where the thread goes on

      Next : Thread_Id;
      --  In the ready queue, the alarm queue or the activation chain: never in two of them

      Entry_Parameters : System.Address;
      --  Of the protected entry call that the thread waits for

      Base_Priority : Integer;

      State : Thread_State;
      pragma Volatile (State);

      Name         : System.Address;
      Name_Length  : Natural;
      Next_Created : Thread_Id;

      Wake : Units;
      --  Of the latest delay until

      Stack_Base : System.Address;
      --  Lowest address

      Stack_Size : Natural;
      --  In bytes
   end record
     with Size => 56 * 8, Alignment => 8, Suppress_Initialization;
   --  Starts as zeros: threads are static, and no elaboration may touch them once the kernel runs

   for Thread use record
      Active           at 0 range 0 .. 31;
      Secondary_Stack  at 4 range 0 .. 31;
      Stack_Pointer    at 8 range 0 .. 31;
      Next             at 12 range 0 .. 31;
      Entry_Parameters at 16 range 0 .. 31;
      Base_Priority    at 20 range 0 .. 31;
      State            at 24 range 0 .. 31;
      Name             at 28 range 0 .. 31;
      Name_Length      at 32 range 0 .. 31;
      Next_Created     at 36 range 0 .. 31;
      Wake             at 40 range 0 .. 63;
      Stack_Base       at 48 range 0 .. 31;
      Stack_Size       at 52 range 0 .. 31;
   end record;
   --  The assembly in arm7tdmi/ uses the offsets of Stack_Pointer, Active and Next

   type Kernel_State is record
      Running : Thread_Id;
      --  Null while the processor idles; read from outside

      Current : Thread_Id;
      --  Never null: as Running, the idle pseudo-thread, or the beginning of a thread that stands
      --  for the interrupt handler being executed (see Ravenbrick.Interrupts)

      Ready_Head : Thread_Id;
      pragma Volatile (Ready_Head);
      --  Ready threads without the running one, most urgent first; ends with a sentinel

      First_Created : Thread_Id;
      --  All threads, latest first; read from outside

      Sentinel : aliased Thread;
      --  Last of the ready queue, less urgent than any thread

      Idle : aliased Thread;
      --  Current while no thread is ready; has no context and no stack
   end record
     with Convention => C;

   Kernel : Kernel_State with Import, Address => To_Address (16#200#);
   --  Fixed by the linker script in the part of the RAM that is shown at address 0 as well, so
   --  that an instruction reaches it without loading its address first

   Environment : aliased Thread
     with Import, Convention => C, External_Name => "ravenbrick_environment";
   --  Runs the elaboration and the main procedure

   procedure Initialize
     with Export, Convention => C, External_Name => "ravenbrick_initialize_threads",
          Post => Kernel.Current = Environment'Access and then Kernel.Running = Kernel.Current;
   --  Make the environment thread, whose code is already executing, the running one

   procedure Set_Environment_Priority (Priority : System.Any_Priority)
     with Pre  => not In_Protected_Action (Environment.Active),
          Post => Environment.Active = To_Urgency (Priority);
   --  Before other threads exist

   Least_Stack : constant := 128;
   --  A preemption and a service of the kernel

   procedure Create
     (Created    : not null Thread_Id;
      Priority   : System.Any_Priority;
      Stack_Base : System.Address;
      Stack_Size : Natural;
      Code       : System.Address;
      Argument   : System.Address)
     with Pre  => Stack_Size >= Least_Stack,
          Post => Created.State = Unstarted and then Created.Active = To_Urgency (Priority);
   --  Prepare a thread that will call Code (Argument) on the stack of Stack_Size bytes. It is
   --  recorded as created, but is not ready.

   function Interrupts_Masked return Boolean
     with Import, External_Name => "ravenbrick_interrupts_masked";
   --  For contracts; what is not checked does not call it

   --  The operations below are called with interrupts masked. Self is Kernel.Current.

   procedure Make_Ready (Woken : not null Thread_Id)
     with Inline,
          Global => (In_Out => Kernel),
          Pre    => Interrupts_Masked and then Woken.State /= Terminated,
          Post   => Woken.State = Ready and then Kernel.Ready_Head.Active >= Woken.Active;
   --  Append to the ready queue of its priority; does not dispatch

   --  Those that follow are called by threads only, and return with interrupts unmasked

   procedure Release (Self, Woken : not null Thread_Id)
     with Inline,
          Global => (In_Out => Kernel),
          Pre    => Interrupts_Masked and then Self = Kernel.Current and then Woken /= Self
                    and then Woken.State /= Terminated,
          Post   => Kernel.Current.State = Ready and then not Interrupts_Masked;
   --  Make Woken ready and let it run before the caller if it is more urgent

   procedure Block (Self : not null Thread_Id)
     with Inline,
          Global => (In_Out => Kernel),
          Pre    => Interrupts_Masked and then Self = Kernel.Current and then Self.State /= Ready
                    and then not In_Protected_Action (Self.Active),
          Post   => Kernel.Current.State = Ready and then not Interrupts_Masked;
   --  Leave the processor to the most urgent ready thread, or to none. Returns when another
   --  has made the caller ready and it is dispatched again. The caller has set its own State.

   procedure Preempt
     with Global => (In_Out => Kernel),
          Pre    => Interrupts_Masked,
          Post   => Kernel.Current.State = Ready and then not Interrupts_Masked;
   --  Let a more urgent ready thread run before the caller

   procedure Yield (Self : not null Thread_Id)
     with Global => (In_Out => Kernel),
          Pre    => Interrupts_Masked and then Self = Kernel.Current
                    and then not In_Protected_Action (Self.Active),
          Post   => Kernel.Current.State = Ready and then not Interrupts_Masked;
   --  Put the caller at the tail of the queue of its priority (RM D.2.3 (8))

   procedure Terminate_Current
     with Export, Convention => C, External_Name => "ravenbrick_terminate", No_Return,
          Global => (In_Out => Kernel);
   --  The running thread never runs again

end Ravenbrick.Threads;
