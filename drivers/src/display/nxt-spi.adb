--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with NXT.Priorities;
with NXT.Registers.SPI;  use NXT.Registers, NXT.Registers.SPI;
with NXT.SPI.Bus;

package body NXT.SPI is

   use type Word;

   Controller : Registers.SPI.Peripheral renames Registers.SPI.SPI;

   type List_Number is range 1 .. 2;

   type List_Buffer is record
      Length : Natural := 0;
      Parts  : Segment_List (1 .. Maximum_Segments);
   end record;

   type List_Buffers is array (List_Number) of List_Buffer;

   protected Transfer with Interrupt_Priority => Priorities.SPI_Interrupt is
      procedure Submit (List : Segment_List);
      procedure Withdraw (Withdrawn : out Boolean);
      procedure Start_If_Idle (List : Segment_List; Started : out Boolean);
      entry Await_Idle;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.SPI;
      procedure Fill (Number : List_Number; List : Segment_List);
      procedure Begin_List (Number : List_Number);
      procedure Feed (Part : Segment);
      procedure Finish_Segment;

      Lists   : List_Buffers;
      Current : List_Number := 1;
      Next    : Positive := 1;
      Idle    : Boolean := True;
      Waiting : Boolean := False;
   end Transfer;
   --  Waiting: the list that is not Current begins when Current is through.

   protected body Transfer is

      procedure Feed (Part : Segment) is
      begin
         Bus.Announce (Part.Kind);
         Controller.PERIPH_TPR := Part.Start;
         Controller.PERIPH_TCR := Word (Part.Length);
         Controller.SPI_IER := DMA_Ended;
      end Feed;

      procedure Fill (Number : List_Number; List : Segment_List) is
      begin
         Lists (Number).Length := List'Length;
         Lists (Number).Parts (1 .. List'Length) := List;
      end Fill;

      procedure Begin_List (Number : List_Number) is
      begin
         Current := Number;
         Next := 1;
         Idle := False;
         Waiting := False;
         Feed (Lists (Number).Parts (1));
      end Begin_List;

      procedure Submit (List : Segment_List) is
         Other : constant List_Number := 3 - Current;
      begin
         Fill (Other, List);
         if Idle then
            Begin_List (Other);
         else
            Waiting := True;
         end if;
      end Submit;

      procedure Withdraw (Withdrawn : out Boolean) is
      begin
         Withdrawn := Waiting;
         Waiting := False;
      end Withdraw;

      procedure Start_If_Idle (List : Segment_List; Started : out Boolean) is
      begin
         Started := Idle;
         if Idle then
            Fill (Current, List);
            Begin_List (Current);
         end if;
      end Start_If_Idle;

      entry Await_Idle when Idle is
      begin
         null;
      end Await_Idle;

      procedure Finish_Segment is
      begin
         if Next < Lists (Current).Length then
            Next := Next + 1;
            Feed (Lists (Current).Parts (Next));
         elsif Waiting then
            Begin_List (3 - Current);
         else
            Idle := True;
         end if;
      end Finish_Segment;

      --  The line that tells commands from pixels may change only when the last bit is out, which
      --  is later than the end of the DMA transfer.
      procedure Handle_Interrupt is
         Mask  : constant Word := Controller.SPI_IMR;
         Flags : constant Word := Controller.SPI_SR and Mask;
      begin
         if Has (Flags, DMA_Ended) then
            Controller.SPI_IDR := DMA_Ended;
            Controller.SPI_IER := Nothing_Left;
         elsif Has (Flags, Nothing_Left) then
            Controller.SPI_IDR := Nothing_Left;
            Finish_Segment;
         end if;
      end Handle_Interrupt;

   end Transfer;

   procedure Submit (List : Segment_List) is
   begin
      Transfer.Submit (List);
   end Submit;

   procedure Withdraw (Withdrawn : out Boolean) is
   begin
      Transfer.Withdraw (Withdrawn);
   end Withdraw;

   procedure Await_Idle is
   begin
      Transfer.Await_Idle;
   end Await_Idle;

   --  A list submitted by another task may begin between the two calls.
   procedure Start (List : Segment_List) is
      Started : Boolean;
   begin
      loop
         Transfer.Await_Idle;
         Transfer.Start_If_Idle (List, Started);
         exit when Started;
      end loop;
   end Start;

   procedure Send (Kind : Segment_Kind; Data : System.Address; Length : Segment_Length) is
   begin
      Start ((1 => (Kind, Data, Length)));
      Await_Idle;
   end Send;

   procedure Send (Is_Data : Boolean; Buf : System.Address; Len : Natural) is
   begin
      Send ((if Is_Data then Pixels else Command), Buf, Len);
   end Send;

begin
   Bus.Configure;
   Controller.PERIPH_PTCR := DMA_Transmit_Enable;
end NXT.SPI;
