--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The path from the level of a source to the interrupt handler.

package Interrupt_Timing is

   procedure Measure;
   --  Delays of the interrupt controller, of a pin, and of the processor; masks; DMA.

end Interrupt_Timing;
