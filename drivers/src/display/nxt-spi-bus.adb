--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.SPI;

package body NXT.SPI.Bus is

   use type Word;

   Controller : Registers.SPI.Peripheral renames Registers.SPI.SPI;

   Selector  : constant Word := Bit (Display_Data);
   A_Lines   : constant Word := Bit (SPI_Output) or Bit (SPI_Clock);
   B_Lines   : constant Word := Bit (Display_Select);

   --  Polls before a silent interface is given up: far more than a byte at 2 MHz lasts.
   Patience : constant := 20_000;

   procedure Configure is
      use NXT.Registers.SPI;
   begin
      PMC.PMC.PMC_PCER := Bit (PIOA_Id) or Bit (SPI_Id);
      Controller.SPI_IDR := 16#FFFF_FFFF#;
      Controller.PERIPH_PTCR := DMA_Transmit_Disable;
      Controller.PERIPH_TCR := 0;
      PIOA.PIO_SODR := Selector;
      PIOA.PIO_OER := Selector;
      PIOA.PIO_PER := Selector;
      PIOA.PIO_ASR := A_Lines;
      PIOA.PIO_BSR := B_Lines;
      PIOA.PIO_PDR := A_Lines or B_Lines;
      --  Some revisions of the chip need the reset twice (erratum).
      Controller.SPI_CR := Reset;
      Controller.SPI_CR := Reset;
      Controller.SPI_MR := Master or Ignore_Mode_Fault or Select_Line_2;
      Controller.SPI_CSR2 := Display_Timing;
      Controller.SPI_CR := Enable;
   end Configure;

   procedure Announce (Kind : Segment_Kind) is
   begin
      case Kind is
         when Command => PIOA.PIO_CODR := Selector;
         when Pixels  => PIOA.PIO_SODR := Selector;
      end case;
   end Announce;

   procedure Await (Flag : Word) is
   begin
      for Poll in 1 .. Patience loop
         exit when Has (Controller.SPI_SR, Flag);
      end loop;
   end Await;

   procedure Send_Polled (Kind : Segment_Kind; Data : Byte_Array) is
      use NXT.Registers.SPI;
   begin
      Announce (Kind);
      for Value of Data loop
         Await (Transmit_Ready);
         Controller.SPI_TDR := Word (Value);
      end loop;
      Await (Nothing_Left);
   end Send_Polled;

end NXT.SPI.Bus;
