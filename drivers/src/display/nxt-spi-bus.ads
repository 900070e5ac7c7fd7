--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The display's serial line without interrupts: set-up, and sending by polling for the moments
--  when no handler runs.

package NXT.SPI.Bus is

   procedure Configure;
   --  Reset the interface, DMA included, and set it and its lines up for the display.

   procedure Announce (Kind : Segment_Kind);
   --  Set the line that tells the display what the following bytes are.

   procedure Send_Polled (Kind : Segment_Kind; Data : Byte_Array);
   --  Send Data and wait until its last bit is out.

end NXT.SPI.Bus;
