--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two objects with a handler for one interrupt

with Ada.Interrupts.Names; use Ada.Interrupts;
with System;

package Handled_Twice is

   protected type Source (Id : Interrupt_ID)
     with Interrupt_Priority => System.Interrupt_Priority'First
   is
      procedure Handle with Attach_Handler => Id;
   end Source;

   First  : Source (Names.TC1);
   Second : Source (Names.TC1);

end Handled_Twice;
