--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Ada.Synchronous_Task_Control;  use Ada.Synchronous_Task_Control;
with NXT.Priorities;
with NXT.Registers.SPI;  use NXT.Registers, NXT.Registers.SPI;
with NXT.SPI.Bus;

package body NXT.SPI is

   use type Word;

   Controller : Registers.SPI.Peripheral renames Registers.SPI.SPI;

   Through : Suspension_Object;
   --  Set when nothing is left to send. An entry would be looked at in each interrupt.

   protected Transfer with Interrupt_Priority => Priorities.SPI_Interrupt is
      procedure Submit (List : not null Segment_Access);
      procedure Withdraw (Withdrawn : out Boolean);
      procedure Start_If_Idle (List : not null Segment_Access; Started : out Boolean);
      function Is_Idle return Boolean;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.SPI;
      procedure Feed (Part : not null Segment_Access);
      procedure Finish_Segment;

      Following : Segment_Access;
      Waiting   : Segment_Access;
      Idle      : Boolean := True;
   end Transfer;
   --  Following: the segment after the one that is being sent. Waiting: the list after this one.

   protected body Transfer is

      procedure Feed (Part : not null Segment_Access) is
      begin
         Following := Part.Next;
         Bus.Announce (Part.Kind);
         Controller.PERIPH_TPR := Part.Start;
         Controller.PERIPH_TCR := Word (Part.Length);
         Controller.SPI_IER := DMA_Ended;
      end Feed;

      procedure Submit (List : not null Segment_Access) is
      begin
         if Idle then
            Idle := False;
            Feed (List);
         else
            Waiting := List;
         end if;
      end Submit;

      procedure Withdraw (Withdrawn : out Boolean) is
      begin
         Withdrawn := Waiting /= null;
         Waiting := null;
      end Withdraw;

      procedure Start_If_Idle (List : not null Segment_Access; Started : out Boolean) is
      begin
         Started := Idle;
         if Idle then
            Idle := False;
            Feed (List);
         end if;
      end Start_If_Idle;

      function Is_Idle return Boolean is (Idle);

      procedure Finish_Segment is
         Part : constant Segment_Access := (if Following /= null then Following else Waiting);
      begin
         if Following = null then
            Waiting := null;
         end if;
         if Part /= null then
            Feed (Part);
         else
            Idle := True;
            Set_True (Through);
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

   procedure Submit (List : not null Segment_Access) is
   begin
      Transfer.Submit (List);
   end Submit;

   procedure Withdraw (Withdrawn : out Boolean) is
   begin
      Transfer.Withdraw (Withdrawn);
   end Withdraw;

   procedure Await_Idle is
   begin
      while not Transfer.Is_Idle loop
         Suspend_Until_True (Through);
      end loop;
   end Await_Idle;

   --  A list submitted by another task may begin between two of the calls.
   procedure Send (Kind : Segment_Kind; Data : System.Address; Length : Segment_Length) is
      List    : aliased constant Segment := (Length, Kind, Data, Next => null);
      Started : Boolean;
   begin
      loop
         Await_Idle;
         Transfer.Start_If_Idle (List'Unchecked_Access, Started);
         exit when Started;
      end loop;
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
