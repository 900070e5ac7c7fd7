--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;           use Ada.Real_Time;
with System.Storage_Elements; use System, System.Storage_Elements;

with Mixing;            use Mixing;
with NXT.Registers.PMC; use NXT.Registers;
with NXT.Registers.SPI;

package body Workers is

   use type NXT.Registers.Word;

   Epoch : constant Time := Clock + Milliseconds (20);

   Clock_Divider : constant := 8;
   Memory        : constant System.Address := To_Address (16#20_0000#);
   Most_Bytes    : constant := 2 ** 16 - 1;

   task body Mover is
      Next : Time := Epoch;
   begin
      PMC.PMC.PMC_PCER := Bit (SPI_Id);
      SPI.SPI.SPI_MR := SPI.Master or SPI.Ignore_Mode_Fault or SPI.Select_Line_2;
      SPI.SPI.SPI_CSR2 := SPI.Clock_Idles_High or Clock_Divider * 2 ** 8;
      SPI.SPI.SPI_CR := SPI.Enable;
      SPI.SPI.PERIPH_PTCR := SPI.DMA_Transmit_Enable;
      loop
         delay until Next;
         SPI.SPI.PERIPH_TPR := Memory;
         SPI.SPI.PERIPH_TCR := Most_Bytes;
         Next := Next + Milliseconds (80);
      end loop;
   end Mover;

   task body Computation is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (60_000);
         Next := Next + Milliseconds (20);
      end loop;
   end Computation;

end Workers;
