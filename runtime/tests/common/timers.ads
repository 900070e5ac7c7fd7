--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Channels 1 and 2 of the timer counter as sources of interrupts (datasheet section 33)

with System.Storage_Elements; use System.Storage_Elements;

package Timers is

   type Word is mod 2 ** 32;

   type Channel is limited record
      Control : Word;  --  CCR
      Mode    : Word;  --  CMR
      Value   : Word;  --  CV
      Compare : Word;  --  RC
      Status  : Word;  --  SR
      Enable  : Word;  --  IER
   end record
     with Volatile;
   for Channel use record
      Control at 16#00# range 0 .. 31;
      Mode    at 16#04# range 0 .. 31;
      Value   at 16#10# range 0 .. 31;
      Compare at 16#1C# range 0 .. 31;
      Status  at 16#20# range 0 .. 31;
      Enable  at 16#24# range 0 .. 31;
   end record;

   Channel_1 : aliased Channel with Import, Address => To_Address (16#FFFA_0040#);
   Channel_2 : aliased Channel with Import, Address => To_Address (16#FFFA_0080#);

   procedure Start_Once (Timer : in out Channel; Counts : Word);
   --  Request an interrupt in Counts * 2 cycles of the processor

   procedure Start_Cyclic (Timer : in out Channel; Counts : Word);
   --  Request an interrupt every Counts * 2 cycles of the processor

   procedure Start_Stopwatch (Timer : in out Channel);
   --  Let Value count every 2 cycles of the processor, modulo 2**16

   procedure Acknowledge (Timer : Channel) with Inline;
   --  Withdraw the request

end Timers;
