--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts;

package Handlers is

   protected Box with Interrupt_Priority => 33 is
      procedure Fire;
   private
      Count : Natural := 0;
   end Box;

   Handler : Ada.Interrupts.Parameterless_Handler := Box.Fire'Access with Volatile;

end Handlers;
