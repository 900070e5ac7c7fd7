--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Interrupt sources of the AT91SAM7S256, named after its peripherals (datasheet section 10.2).
--  Attaching a handler sets the source's type to 0 (SRCTYPE, datasheet 23.9.3): a peripheral
--  requests while its signal is high, so that the handler must withdraw the request at the
--  peripheral; the pins FIQ, IRQ0 and IRQ1 request while they are low. A handler of a pin that
--  is to react to its edge must wait for the end of the pulse or use PIOA, which notices changes
--  of any pin. FIQ reaches the fast interrupt, which stays masked: its handler is never called.

package Ada.Interrupts.Names is

   FIQ   : constant Interrupt_ID := 0;
   SYSC  : constant Interrupt_ID := 1;
   PIOA  : constant Interrupt_ID := 2;
   ADC   : constant Interrupt_ID := 4;
   SPI   : constant Interrupt_ID := 5;
   US0   : constant Interrupt_ID := 6;
   US1   : constant Interrupt_ID := 7;
   SSC   : constant Interrupt_ID := 8;
   TWI   : constant Interrupt_ID := 9;
   PWMC  : constant Interrupt_ID := 10;
   UDP   : constant Interrupt_ID := 11;
   TC0   : constant Interrupt_ID := 12;
   TC1   : constant Interrupt_ID := 13;
   TC2   : constant Interrupt_ID := 14;
   IRQ0  : constant Interrupt_ID := 30;
   IRQ1  : constant Interrupt_ID := 31;

end Ada.Interrupts.Names;
