--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with NXT.Priorities;
with NXT.Registers.SPI;  use NXT.Registers, NXT.Registers.SPI;
with NXT.SPI.Bus;

package body NXT.SPI is

   use type Word;

   Controller : Registers.SPI.Peripheral renames Registers.SPI.SPI;

   protected Transfer with Interrupt_Priority => Priorities.SPI_Interrupt is
      procedure Start (List : Segment_List);
      entry Await_Idle;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.SPI;
      procedure Feed (Part : Segment);
      procedure Finish_Segment;

      Idle   : Boolean := True;
      Parts  : Segment_List (1 .. Maximum_Segments);
      Next   : Positive := 1;
      Length : Natural := 0;
   end Transfer;

   protected body Transfer is

      procedure Feed (Part : Segment) is
      begin
         Bus.Announce (Part.Kind);
         Controller.DMA_Address := Part.Start;
         Controller.DMA_Count := Word (Part.Length);
         Controller.Enable_Interrupt := DMA_Ended;
      end Feed;

      procedure Start (List : Segment_List) is
      begin
         Length := List'Length;
         Parts (1 .. Length) := List;
         Next := 1;
         Idle := False;
         Feed (Parts (Next));
      end Start;

      entry Await_Idle when Idle is
      begin
         null;
      end Await_Idle;

      procedure Finish_Segment is
      begin
         if Next < Length then
            Next := Next + 1;
            Feed (Parts (Next));
         else
            Idle := True;
         end if;
      end Finish_Segment;

      --  The line that tells commands from pixels may change only when the last bit is out, which
      --  is later than the end of the DMA transfer.
      procedure Handle_Interrupt is
         Mask  : constant Word := Controller.Interrupt_Mask;
         Flags : constant Word := Controller.Status and Mask;
      begin
         if Has (Flags, DMA_Ended) then
            Controller.Disable_Interrupt := DMA_Ended;
            Controller.Enable_Interrupt := Nothing_Left;
         elsif Has (Flags, Nothing_Left) then
            Controller.Disable_Interrupt := Nothing_Left;
            Finish_Segment;
         end if;
      end Handle_Interrupt;

   end Transfer;

   procedure Await_Idle is
   begin
      Transfer.Await_Idle;
   end Await_Idle;

   procedure Start (List : Segment_List) is
   begin
      Transfer.Await_Idle;
      Transfer.Start (List);
   end Start;

   procedure Send (Kind : Segment_Kind; Data : System.Address; Length : Segment_Length) is
   begin
      Start ((1 => (Kind, Data, Length)));
      Await_Idle;
   end Send;

begin
   Bus.Configure;
   Controller.DMA_Control := DMA_Transmit_Enable;
end NXT.SPI;
