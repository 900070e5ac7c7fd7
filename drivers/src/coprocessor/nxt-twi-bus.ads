--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The two-wire bus without interrupts: set-up, and transfers by polling for the moments when no
--  handler runs.

package NXT.TWI.Bus is

   procedure Reset;
   --  Clock out whatever a device still wants to send, send a stop condition, reset the interface
   --  and set it up as a master at 400 kHz. Takes less than 0.3 ms.

   procedure Send_Polled (Device : Device_Id; Message : Byte_Array; Acknowledged : out Boolean);
   --  Send Message and wait for the end of the transfer. Acknowledged is False when the device
   --  refused a byte or the interface did not answer in time.

   procedure Receive_Polled (Device : Device_Id; Message : out Byte_Array; Complete : out Boolean)
     with Pre => Message'Length >= 2;
   --  Fill Message and wait for the end of the transfer. Complete is False, and the rest of Message
   --  zero, when the device did not answer or the interface did not in time.

end NXT.TWI.Bus;
