--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Priorities of the drivers. Among interrupts the shortest deadline comes first: a byte on the
--  co-processor link takes 22 us and what the co-processor holds the clock (20 us), a motor edge
--  stays at least 0.5 ms and must not be miscounted; a late tick of the sensors' buses makes them
--  slower and nothing else, the display can wait, sound has a buffer of some milliseconds, and a
--  USB host tries again for as long as it takes.

with System;

package NXT.Priorities with Pure, SPARK_Mode is

   Regulator_Task   : constant System.Priority := System.Priority'Last - 1;

   Shared_Data      : constant System.Priority := System.Priority'Last;
   --  Ceiling of data that any task may read or write.

   TWI_Interrupt     : constant System.Interrupt_Priority := System.Interrupt_Priority'Last;
   Encoder_Interrupt : constant System.Interrupt_Priority := TWI_Interrupt - 1;
   I2C_Interrupt     : constant System.Interrupt_Priority := Encoder_Interrupt - 1;
   Color_Interrupt   : constant System.Interrupt_Priority := I2C_Interrupt;
   RS485_Interrupt   : constant System.Interrupt_Priority := I2C_Interrupt - 1;
   SPI_Interrupt     : constant System.Interrupt_Priority := RS485_Interrupt - 1;
   Audio_Interrupt   : constant System.Interrupt_Priority := SPI_Interrupt - 1;
   USB_Interrupt     : constant System.Interrupt_Priority := Audio_Interrupt - 1;

end NXT.Priorities;
