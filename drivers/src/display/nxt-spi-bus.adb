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
      PMC.PMC.Enable_Clock := Bit (PIOA_Id) or Bit (SPI_Id);
      Controller.Disable_Interrupt := 16#FFFF_FFFF#;
      Controller.DMA_Control := DMA_Transmit_Disable;
      Controller.DMA_Count := 0;
      PIOA.Set_Output := Selector;
      PIOA.Enable_Output := Selector;
      PIOA.Take_Line := Selector;
      PIOA.Select_A := A_Lines;
      PIOA.Select_B := B_Lines;
      PIOA.Give_To_Peripheral := A_Lines or B_Lines;
      Controller.Control := Reset;
      Controller.Mode := Master or Ignore_Mode_Fault or Select_Line_2;
      Controller.Chip_Select_2 := Display_Timing;
      Controller.Control := Enable;
   end Configure;

   procedure Announce (Kind : Segment_Kind) is
   begin
      case Kind is
         when Command => PIOA.Clear_Output := Selector;
         when Pixels  => PIOA.Set_Output := Selector;
      end case;
   end Announce;

   procedure Await (Flag : Word) is
   begin
      for Poll in 1 .. Patience loop
         exit when Has (Controller.Status, Flag);
      end loop;
   end Await;

   procedure Send_Polled (Kind : Segment_Kind; Data : Byte_Array) is
      use NXT.Registers.SPI;
   begin
      Announce (Kind);
      for Value of Data loop
         Await (Transmit_Ready);
         Controller.Transmit := Word (Value);
      end loop;
      Await (Nothing_Left);
   end Send_Polled;

end NXT.SPI.Bus;
