--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  USB device port (datasheet, chapter UDP).

with System;

package NXT.Registers.UDP is

   type Endpoint is range 0 .. 3;
   type Endpoint_Words is array (Endpoint) of Word with Atomic_Components;

   type Peripheral is record
      Global_State      : Word with Atomic;
      Function_Address  : Word with Atomic;
      Enable_Interrupt  : Word with Atomic;
      Disable_Interrupt : Word with Atomic;
      Interrupts        : Word with Atomic;
      Clear_Interrupt   : Word with Atomic;
      Reset_Endpoint    : Word with Atomic;
      Control           : Endpoint_Words;
      Data              : Endpoint_Words;
      Transceiver       : Word with Atomic;
   end record;

   for Peripheral use record
      Global_State      at 16#04# range 0 .. 31;
      Function_Address  at 16#08# range 0 .. 31;
      Enable_Interrupt  at 16#10# range 0 .. 31;
      Disable_Interrupt at 16#14# range 0 .. 31;
      Interrupts        at 16#1C# range 0 .. 31;
      Clear_Interrupt   at 16#20# range 0 .. 31;
      Reset_Endpoint    at 16#28# range 0 .. 31;
      Control           at 16#30# range 0 .. 127;
      Data              at 16#50# range 0 .. 127;
      Transceiver       at 16#74# range 0 .. 31;
   end record;

   UDP : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFB_0000#);

   --  System clock of the port, among the clocks of PMC.Enable_System_Clock
   Port_Clock : constant Word := Bit (7);

   --  Global_State
   Addressed  : constant Word := Bit (0);
   Configured : constant Word := Bit (1);

   --  Function_Address
   Enable_Function : constant Word := Bit (8);

   --  Interrupts: bit N of endpoint N, and
   Suspended    : constant Word := Bit (8);
   Resumed      : constant Word := Bit (9);
   Start_Frame  : constant Word := Bit (11);
   End_Of_Reset : constant Word := Bit (12);
   Woken_Up     : constant Word := Bit (13);
   Bus_Events   : constant Word := Suspended or Resumed or Start_Frame or End_Of_Reset or Woken_Up;

   --  Control of an endpoint
   Sent            : constant Word := Bit (0);
   Bank_0_Received : constant Word := Bit (1);
   Setup_Received  : constant Word := Bit (2);
   Stall_Sent      : constant Word := Bit (3);
   Packet_Ready    : constant Word := Bit (4);
   Stall           : constant Word := Bit (5);
   Bank_1_Received : constant Word := Bit (6);
   To_Host         : constant Word := Bit (7);
   Bulk_Out        : constant Word := 2 * Bit (8);
   Bulk_In         : constant Word := 6 * Bit (8);
   Enabled         : constant Word := Bit (15);

   Kept_By_Ones : constant Word :=
     Sent or Bank_0_Received or Setup_Received or Stall_Sent or Bank_1_Received;
   --  Flags that the port sets and a written zero clears.

   function Received_Count (Control : Word) return Natural is
     (Natural ((Control / 2 ** 16) and 16#7FF#));

   --  Transceiver
   Disable_Transceiver : constant Word := Bit (8);

end NXT.Registers.UDP;
