--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Identification of interrupts (Ada RM C.3.2). Handlers are attached by pragma Attach_Handler
--  only: the profiles forbid every operation of this package (No_Dynamic_Attachment, RM D.7 (10)).
--  They are declared so that the compiler can say so; there is nothing behind them.

with System;
with System.Interrupts;

package Ada.Interrupts is

   type Interrupt_ID is new System.Interrupts.Ada_Interrupt_ID;

   type Parameterless_Handler is access protected procedure;

   function Is_Reserved (Interrupt : Interrupt_ID) return Boolean with Import;

   function Is_Attached (Interrupt : Interrupt_ID) return Boolean with Import;

   function Current_Handler (Interrupt : Interrupt_ID) return Parameterless_Handler with Import;

   procedure Attach_Handler
     (New_Handler : Parameterless_Handler; Interrupt : Interrupt_ID) with Import;

   procedure Exchange_Handler
     (Old_Handler : out Parameterless_Handler;
      New_Handler : Parameterless_Handler;
      Interrupt   : Interrupt_ID) with Import;

   procedure Detach_Handler (Interrupt : Interrupt_ID) with Import;

   function Reference (Interrupt : Interrupt_ID) return System.Address with Import;

end Ada.Interrupts;
