--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  USB device port (datasheet, chapter UDP).

with System;

package NXT.Registers.UDP is

   type Endpoint is range 0 .. 3;
   type Endpoint_Words is array (Endpoint) of Word with Atomic_Components;

   type Peripheral is record
      UDP_GLB_STAT : Word with Atomic;  --  global state
      UDP_FADDR    : Word with Atomic;  --  function address
      UDP_IER      : Word with Atomic;  --  enables interrupts
      UDP_IDR      : Word with Atomic;  --  disables interrupts
      UDP_ISR      : Word with Atomic;  --  pending interrupts
      UDP_ICR      : Word with Atomic;  --  clears interrupts
      UDP_RST_EP   : Word with Atomic;  --  resets endpoints
      UDP_CSR      : Endpoint_Words;    --  control and status of an endpoint
      UDP_FDR      : Endpoint_Words;    --  FIFO of an endpoint
      UDP_TXVC     : Word with Atomic;  --  transceiver
   end record;

   for Peripheral use record
      UDP_GLB_STAT at 16#04# range 0 .. 31;
      UDP_FADDR    at 16#08# range 0 .. 31;
      UDP_IER      at 16#10# range 0 .. 31;
      UDP_IDR      at 16#14# range 0 .. 31;
      UDP_ISR      at 16#1C# range 0 .. 31;
      UDP_ICR      at 16#20# range 0 .. 31;
      UDP_RST_EP   at 16#28# range 0 .. 31;
      UDP_CSR      at 16#30# range 0 .. 127;
      UDP_FDR      at 16#50# range 0 .. 127;
      UDP_TXVC     at 16#74# range 0 .. 31;
   end record;

   UDP : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFB_0000#);

   --  System clock of the port in PMC_SCER
   Port_Clock : constant Word := Bit (7);

   --  UDP_GLB_STAT
   Addressed  : constant Word := Bit (0);  --  FADDEN
   Configured : constant Word := Bit (1);  --  CONFG

   --  UDP_FADDR
   Enable_Function : constant Word := Bit (8);  --  FEN

   --  UDP_ISR: bit N of endpoint N, and
   Suspended    : constant Word := Bit (8);   --  RXSUSP
   Resumed      : constant Word := Bit (9);   --  RXRSM
   Start_Frame  : constant Word := Bit (11);  --  SOFINT
   End_Of_Reset : constant Word := Bit (12);  --  ENDBUSRES
   Woken_Up     : constant Word := Bit (13);  --  WAKEUP
   Bus_Events   : constant Word := Suspended or Resumed or Start_Frame or End_Of_Reset or Woken_Up;

   --  UDP_CSR of an endpoint
   Sent            : constant Word := Bit (0);      --  TXCOMP
   Bank_0_Received : constant Word := Bit (1);      --  RX_DATA_BK0
   Setup_Received  : constant Word := Bit (2);      --  RXSETUP
   Stall_Sent      : constant Word := Bit (3);      --  STALLSENT
   Packet_Ready    : constant Word := Bit (4);      --  TXPKTRDY
   Stall           : constant Word := Bit (5);      --  FORCESTALL
   Bank_1_Received : constant Word := Bit (6);      --  RX_DATA_BK1
   To_Host         : constant Word := Bit (7);      --  DIR
   Bulk_Out        : constant Word := 2 * Bit (8);  --  EPTYPE
   Bulk_In         : constant Word := 6 * Bit (8);  --  EPTYPE
   Enabled         : constant Word := Bit (15);     --  EPEDS

   Kept_By_Ones : constant Word :=
     Sent or Bank_0_Received or Setup_Received or Stall_Sent or Bank_1_Received;
   --  Flags that the port sets and a written zero clears.

   function Received_Count (Control : Word) return Natural is
     (Natural ((Control / 2 ** 16) and 16#7FF#));

   --  UDP_TXVC
   Disable_Transceiver : constant Word := Bit (8);  --  TXVDIS

end NXT.Registers.UDP;
