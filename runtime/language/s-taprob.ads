--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Protected objects without entries: immediate ceiling locking (Ada RM D.3). On one processor
--  nobody else can be inside when a caller has reached the ceiling, so that a lock is a change
--  of the caller's urgency. The compiler puts the common case of it in line.

with Ravenbrick.Threads;

package System.Tasking.Protected_Objects is
   pragma Preelaborate;

   Null_Protected_Entry : constant := Null_Entry;
   Max_Protected_Entry  : constant := Max_Entry;

   type Protected_Entry_Index is new Entry_Index
     range Null_Protected_Entry .. Max_Protected_Entry;

   type Barrier_Function_Pointer is access
     function (O : System.Address; E : Protected_Entry_Index) return Boolean;
   pragma Favor_Top_Level (Barrier_Function_Pointer);
   --  The barrier of entry E of the protected object at O

   type Entry_Action_Pointer is access
     procedure (O : System.Address; P : System.Address; E : Protected_Entry_Index);
   pragma Favor_Top_Level (Entry_Action_Pointer);
   --  The body of entry E of the protected object at O with the parameters at P

   type Entry_Body is record
      Barrier : Barrier_Function_Pointer;
      Action  : Entry_Action_Pointer;
   end record;

   type Protection is limited private;

   type Protection_Access is access all Protection;

   procedure Initialize_Protection (Object : Protection_Access; Ceiling_Priority : Integer);
   --  Set the ceiling; Unspecified_Priority stands for Priority'Last

   procedure Lock (Object : Protection_Access);
   pragma Inline_Always (Lock);
   --  Enter a protected action; Program_Error when the caller is above the ceiling

   procedure Lock_Read_Only (Object : Protection_Access);
   pragma Inline_Always (Lock_Read_Only);
   --  Enter a protected function

   procedure Unlock (Object : Protection_Access);
   pragma Inline_Always (Unlock);
   --  Leave the protected action, and the processor to a more urgent thread made ready in it

   --  For the child package

   procedure Leave (Object : not null Protection_Access);
   --  As Unlock, but keep the processor

private

   subtype Urgency is Ravenbrick.Threads.Urgency;

   type Protection is limited record
      Ceiling : Urgency;
      --  Inside the protected action

      Span : Urgency;
      --  How far below the ceiling a caller may be that needs no mask of interrupts

      Caller : Urgency;
      --  To which the thread inside returns; below 0: to the complement of it, with the mask of
      --  interrupts lowered

      Mask : Urgency;
      --  To which the mask of interrupts returns
   end record
     with Suppress_Initialization;

   --  The rare cases of Lock and Unlock

   procedure Lock_With_Mask (Object : not null Protection_Access);
   procedure Lower_Mask (Object : not null Protection_Access; Caller : out Urgency);
   procedure Dispatch;

end System.Tasking.Protected_Objects;
