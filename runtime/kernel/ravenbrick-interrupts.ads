--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Interrupt handlers and the masking of interrupts by priority. Interrupt_Priority'First + L
--  is level L of the interrupt controller: a higher level interrupts a handler of a lower one.

with System;

with Ravenbrick.Registers;
with Ravenbrick.Threads;

package Ravenbrick.Interrupts is
   pragma Preelaborate;

   procedure Initialize
     with Export, Convention => C, External_Name => "ravenbrick_initialize_interrupts",
          Pre  => Threads.Interrupts_Masked,
          Post => (for all Source in Registers.Source_Id => not Is_Attached (Source));
   --  No source enabled, every vector harmless, protect mode on

   procedure Attach
     (Source   : Registers.Source_Id;
      Priority : System.Interrupt_Priority;
      Code     : System.Address;
      Object   : System.Address)
     with Post => Is_Attached (Source);
   --  From now on Source calls Code (Object) at Priority, in Supervisor mode

   function Is_Attached (Source : Registers.Source_Id) return Boolean;

   function Source_Of (Current : System.Address) return Integer
     with Post => Source_Of'Result in -1 .. 31;
   --  The source of the handler that Kernel.Current names, -1 when it names a thread

   procedure Raise_Mask (Ceiling : Threads.Urgency; Saved : out Threads.Urgency)
     with Pre => Threads.">=" (Ceiling, Threads.First_Interrupt_Urgency)
                 and then Threads.In_Protected_Action (Ceiling);
   --  Disable the sources at or below Ceiling, an urgency of the interrupt range. Saved is what
   --  Lower_Mask takes.

   procedure Lower_Mask (Ceiling, Saved : Threads.Urgency)
     with Pre => Threads.">=" (Ceiling, Threads.First_Interrupt_Urgency);
   --  Undo the matching Raise_Mask. Saved is above Ceiling in a handler that was entered between
   --  the two writes of another Raise_Mask: the sources then stay disabled.

end Ravenbrick.Interrupts;
