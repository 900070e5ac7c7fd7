--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The two-wire bus without interrupts: set-up, and sending by polling for the moments when no
--  handler runs.

package NXT.TWI.Bus is

   procedure Reset;
   --  Clock out whatever a device still wants to send, send a stop condition, reset the interface
   --  and set it up as a master at 400 kHz. Takes less than 0.3 ms.

   procedure Send_Polled (Device : Device_Id; Message : Byte_Array; Acknowledged : out Boolean);
   --  Send Message and wait for the end of the transfer. Acknowledged is False when the device
   --  refused a byte or the interface did not answer in time.

end NXT.TWI.Bus;
