--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;          use Interfaces;
with NXT.Converter;
with NXT.Registers.ADC;
with NXT.Registers.PIO;    use NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.USART;  use NXT.Registers, NXT.Registers.USART;

package body NXT.Bluetooth_Line is

   Controller : Registers.USART.Peripheral renames Registers.USART.USART1;

   Reset_Line  : constant Word := Bit (Bluetooth_Reset);
   Stream_Line : constant Word := Bit (Bluetooth_Stream);
   Select_Line : constant Word := Bit (Bluetooth_Select);
   Serial      : constant Word := Bit (Bluetooth_Input) or Bit (Bluetooth_Output)
     or Bit (Bluetooth_Ready) or Bit (Bluetooth_Go);

   --  460.8 kBd within 0.3 per cent: the master clock divided by eight times this
   Divider : constant := 13;

   --  Received: the DMA fills one buffer while the other waits or is read. Current is read; when
   --  all of it is, it goes back to the DMA.

   Buffer_Size : constant := 128;
   subtype Buffer_Place is Positive range 1 .. Buffer_Size;
   type Buffer_Id is mod 2;
   type Buffers is array (Buffer_Id) of Byte_Array (Buffer_Place);

   Received : Buffers;
   Current  : Buffer_Id := 0;
   Read     : Natural range 0 .. Buffer_Size := 0;

   --  Sent: a ring; the part that the DMA has is In_Flight bytes from Oldest on.

   type Ring_Place is mod Send_Capacity;
   type Ring is array (Ring_Place) of Byte;

   Outgoing  : Ring;
   Oldest    : Ring_Place := 0;
   Waiting   : Natural range 0 .. Send_Capacity - 1 := 0;
   In_Flight : Natural range 0 .. Send_Capacity - 1 := 0;
   --  Waiting: bytes in the ring, those in flight among them.

   procedure Start_DMA is
   begin
      Current := 0;
      Read := 0;
      Controller.PERIPH_RPR := Received (0)'Address;
      Controller.PERIPH_RCR := Buffer_Size;
      Controller.PERIPH_RNPR := Received (1)'Address;
      Controller.PERIPH_RNCR := Buffer_Size;
      Controller.PERIPH_PTCR := DMA_Receive_Enable or DMA_Send_Enable;
   end Start_DMA;

   procedure Power_Off is
   begin
      PIOA.PIO_CODR := Reset_Line or Stream_Line;
   end Power_Off;

   procedure Power_On is
   begin
      Controller.PERIPH_PTCR := DMA_Receive_Disable or DMA_Send_Disable;
      Controller.US_CR := Reset_Receiver or Reset_Transmitter;
      Controller.PERIPH_TCR := 0;
      Waiting := 0;
      In_Flight := 0;
      Start_DMA;
      Controller.US_CR := Enable_Receiver or Enable_Transmitter;
      PIOA.PIO_SODR := Reset_Line;
   end Power_On;

   procedure Request_Stream (On : Boolean) is
   begin
      if On then
         PIOA.PIO_SODR := Stream_Line;
      else
         PIOA.PIO_CODR := Stream_Line;
      end if;
   end Request_Stream;

   Half_Scale : constant := 512;

   procedure Read_Mode (Is_Stream : out Boolean) is
   begin
      Is_Stream := Converter.Count (Registers.ADC.Bluetooth_Channel) > Half_Scale;
      Converter.Start;
   end Read_Mode;

   --  What is sent makes room; what waits goes to an idle DMA, up to the end of the ring.
   procedure Send_Next_Block is
   begin
      if Controller.PERIPH_TCR > 0 then
         return;
      end if;
      Oldest := Oldest + Ring_Place (In_Flight);
      Waiting := Waiting - In_Flight;
      In_Flight := Natural'Min (Waiting, Send_Capacity - Natural (Oldest));
      if In_Flight > 0 then
         Controller.PERIPH_TPR := Outgoing (Oldest)'Address;
         Controller.PERIPH_TCR := Word (In_Flight);
      end if;
   end Send_Next_Block;

   function Room return Natural is
   begin
      Send_Next_Block;
      return Send_Capacity - 1 - Waiting;
   end Room;

   procedure Send (Data : Byte_Array) is
   begin
      for Item of Data loop
         pragma Annotate (Ravenbrick, Iterations, 124, "no frame is longer");
         Outgoing (Oldest + Ring_Place (Waiting)) := Item;
         Waiting := Waiting + 1;
      end loop;
      Send_Next_Block;
   end Send;

   function All_Sent return Boolean is
   begin
      Send_Next_Block;
      return Waiting = 0 and then Has (Controller.US_CSR, Sent);
   end All_Sent;

   procedure Discard_Unsent is
   begin
      Controller.PERIPH_PTCR := DMA_Send_Disable;
      Controller.PERIPH_TCR := 0;
      Waiting := 0;
      In_Flight := 0;
      Controller.PERIPH_PTCR := DMA_Send_Enable;
   end Discard_Unsent;

   --  Bytes of the current buffer that have come. The count is read before the next count: if
   --  there still is a next buffer afterwards, the count was the current one's.
   function Arrived return Natural is
      Left : constant Word := Controller.PERIPH_RCR;
   begin
      return (if Controller.PERIPH_RNCR > 0 then Buffer_Size - Natural (Left)
              else Buffer_Size);
   end Arrived;

   --  The buffer that was read becomes the DMA's next one, or its first when it has none.
   procedure Return_Buffer is
   begin
      Controller.PERIPH_RNPR := Received (Current)'Address;
      Controller.PERIPH_RNCR := Buffer_Size;
      if Controller.PERIPH_RCR = 0 and then Controller.PERIPH_RNCR > 0 then
         Controller.PERIPH_RNCR := 0;
         Controller.PERIPH_RPR := Received (Current)'Address;
         Controller.PERIPH_RCR := Buffer_Size;
      end if;
      Current := Current + 1;
      Read := 0;
   end Return_Buffer;

   procedure Receive (Data : out Byte_Array; Last : out Natural) is
      Available : constant Natural := Arrived;
      Count     : constant Natural := Natural'Min (Data'Length, Available - Read);
   begin
      Data (Data'First .. Data'First + Count - 1) := Received (Current) (Read + 1 .. Read + Count);
      Last := Data'First + Count - 1;
      Read := Read + Count;
      if Read = Buffer_Size then
         Return_Buffer;
      end if;
   end Receive;

   procedure Receive (Item : out Byte; Found : out Boolean) is
   begin
      Item := 0;
      Found := Read < Arrived;
      if Found then
         Read := Read + 1;
         Item := Received (Current) (Read);
         if Read = Buffer_Size then
            Return_Buffer;
         end if;
      end if;
   end Receive;

begin
   PMC.PMC.PMC_PCER := Bit (USART1_Id) or Bit (PIOA_Id);
   PIOA.PIO_CODR := Reset_Line or Stream_Line;
   PIOA.PIO_SODR := Select_Line;
   PIOA.PIO_OER := Reset_Line or Stream_Line or Select_Line;
   PIOA.PIO_PER := Reset_Line or Stream_Line or Select_Line;
   PIOA.PIO_PUDR := Serial;
   PIOA.PIO_ASR := Serial;
   PIOA.PIO_PDR := Serial;
   Controller.US_MR :=
     Hardware_Handshake or Eight_Bits or No_Parity or Eight_Times_Sampling;
   Controller.US_BRGR := Divider;
   Converter.Use_Channel (Registers.ADC.Bluetooth_Channel);
   Converter.Start;
end NXT.Bluetooth_Line;
