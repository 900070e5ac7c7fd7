--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with NXT.Priorities;
with NXT.Registers.PIO;        use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.USART;      use NXT.Registers.USART;
with System.Storage_Elements;

package body NXT.RS485 is

   use System.Storage_Elements;
   use type Word;

   Controller : Registers.USART.Peripheral renames Registers.USART.USART0;

   Pins : constant Word :=
     Bit (RS485_Receive) or Bit (RS485_Send) or Bit (RS485_Direction);

   --  Of four blocks the DMA controller fills one and has another; two wait to be read.
   Block       : constant := 64;
   Ring_Length : constant := 4 * Block;

   type Ring_Index is mod Ring_Length;
   type Ring_Bytes is array (Ring_Index) of Byte with Volatile_Components;

   --  The rate in eighths of the divider: with eight samples a bit lasts as many clocks.
   function Divider_Of (Rate : Bits_Per_Second) return Word is
     ((Clock_Frequency + Word (Rate) / 2) / Word (Rate));

   protected Transfer with Interrupt_Priority => Priorities.RS485_Interrupt is
      procedure Open (Rate : Bits_Per_Second; To : Connection);
      procedure Close;
      procedure Send (Message : Byte_Array; Accepted : out Boolean);
      function Is_Sending return Boolean;
      entry Await_Sent;
      procedure Receive (Data : out Byte_Array; Count : out Natural);
      function Has_Lost return Boolean;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.US0;
      procedure Queue_Next_Block;
      procedure Check_Errors;

      Opened : Boolean := False;
      Idle   : Boolean := True;
      Lost   : Boolean := False;
      Output : Byte_Array (1 .. Longest_Message) := (others => 0);
      Ring   : Ring_Bytes := (others => 0);
      Queued : Ring_Index := 0;
      First  : Ring_Index := 0;
   end Transfer;
   --  Queued: start of the block that the DMA controller got last. First: start of the bytes that
   --  were not read yet.

   protected body Transfer is

      procedure Open (Rate : Bits_Per_Second; To : Connection) is
         Divider : constant Word := Divider_Of (Rate);
      begin
         PMC.PMC.PMC_PCER := Bit (PIOA_Id) or Bit (USART0_Id);
         Controller.US_IDR := 16#FFFF_FFFF#;
         Controller.PERIPH_PTCR := DMA_Receive_Disable or DMA_Send_Disable;
         Controller.US_CR := Reset_Receiver or Reset_Transmitter or Reset_Errors;
         Controller.US_MR := RS485_Direction_Line or Eight_Bits or No_Parity or Eight_Times_Sampling
           or (if To = Loop_Back then Local_Loop else 0);
         Controller.US_BRGR := Divider / 8 or (Divider mod 8) * 2 ** Fraction_Place;
         PIOA.PIO_ASR := Pins;
         PIOA.PIO_PDR := Pins;
         Queued := Block;
         First := 0;
         Lost := False;
         Controller.PERIPH_RPR := Ring (0)'Address;
         Controller.PERIPH_RCR := Block;
         Controller.PERIPH_RNPR := Ring (Block)'Address;
         Controller.PERIPH_RNCR := Block;
         Controller.US_CR := Enable_Receiver or Enable_Transmitter;
         Controller.PERIPH_PTCR := DMA_Receive_Enable or DMA_Send_Enable;
         Controller.US_IER := Receive_Ended;
         Opened := True;
         Idle := True;
      end Open;

      procedure Close is
      begin
         Opened := False;
         Idle := True;
         Controller.US_IDR := 16#FFFF_FFFF#;
         Controller.PERIPH_PTCR := DMA_Receive_Disable or DMA_Send_Disable;
         Controller.US_CR := Disable_Both;
         PIOA.PIO_ODR := Pins;
         PIOA.PIO_PER := Pins;
      end Close;

      procedure Send (Message : Byte_Array; Accepted : out Boolean) is
      begin
         Accepted := Opened and then Idle;
         if Accepted then
            Output (1 .. Message'Length) := Message;
            Idle := False;
            Controller.PERIPH_TPR := Output'Address;
            Controller.PERIPH_TCR := Message'Length;
            Controller.US_IER := Send_Ended;
         end if;
      end Send;

      function Is_Sending return Boolean is (not Idle);

      entry Await_Sent when Idle is
      begin
         null;
      end Await_Sent;

      --  The controller has begun the block given last and gets the one after it, which was filled
      --  two blocks ago. What nobody has taken from it is lost.
      procedure Queue_Next_Block is
         Next : constant Ring_Index := Queued + Block;
      begin
         if First / Block = Next / Block then
            Lost := True;
            First := Next + Block;
         end if;
         Queued := Next;
         Controller.PERIPH_RNPR := Ring (Next)'Address;
         Controller.PERIPH_RNCR := Block;
      end Queue_Next_Block;

      procedure Check_Errors is
      begin
         if Has (Controller.US_CSR, Overrun or Framing_Error) then
            Lost := True;
            Controller.US_CR := Reset_Errors;
         end if;
      end Check_Errors;

      procedure Handle_Interrupt is
         Flags : constant Word := Controller.US_CSR and Controller.US_IMR;
      begin
         if Has (Flags, Receive_Ended) then
            Queue_Next_Block;
         end if;
         if Has (Flags, Send_Ended) then
            Controller.US_IDR := Send_Ended;
            Controller.US_IER := Sent;
         elsif Has (Flags, Sent) then
            Controller.US_IDR := Sent;
            Idle := True;
         end if;
      end Handle_Interrupt;

      procedure Receive (Data : out Byte_Array; Count : out Natural) is
         Now : constant Ring_Index :=
           Ring_Index
             ((To_Integer (Controller.PERIPH_RPR) - To_Integer (Ring'Address))
              mod Ring_Length);
      begin
         Check_Errors;
         Data := (others => 0);
         Count := 0;
         while Opened and then First /= Now and then Count < Data'Length loop
            Data (Data'First + Count) := Ring (First);
            First := First + 1;
            Count := Count + 1;
         end loop;
      end Receive;

      function Has_Lost return Boolean is (Lost);

   end Transfer;

   procedure Open (Rate : Bits_Per_Second := 921_600; To : Connection := Line) is
   begin
      Transfer.Open (Rate, To);
   end Open;

   procedure Close is
   begin
      Transfer.Close;
   end Close;

   procedure Send (Message : Byte_Array; Accepted : out Boolean) is
   begin
      Transfer.Send (Message, Accepted);
   end Send;

   function Sending return Boolean is (Transfer.Is_Sending);

   procedure Await_Sent is
   begin
      Transfer.Await_Sent;
   end Await_Sent;

   procedure Receive (Data : out Byte_Array; Count : out Natural) is
   begin
      Transfer.Receive (Data, Count);
   end Receive;

   function Lost_Bytes return Boolean is (Transfer.Has_Lost);

end NXT.RS485;
