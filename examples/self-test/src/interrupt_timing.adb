--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Chip;
with Link_Timing;
with NXT;                      use NXT;
with NXT.Registers;            use NXT.Registers;
with NXT.Registers.PIO;        use NXT.Registers.PIO;
with NXT.Registers.SPI;
with Results;
with Sequences;                use Sequences;
with System;
with System.Storage_Elements;  use System.Storage_Elements;

package body Interrupt_Timing is

   use type Word;

   Cycles : constant String := "cycles";

   Handled_At : Word := 0 with Atomic;
   --  The stopwatch as the handler reads it

   protected Alarm_Handler with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Handle with Attach_Handler => Ada.Interrupts.Names.TC2;
   end Alarm_Handler;
   pragma Unreferenced (Alarm_Handler);

   protected body Alarm_Handler is

      procedure Handle is
      begin
         Handled_At := Chip.Stopwatch.Value;
         Chip.Alarm.Disable := Chip.Compare_Event;
      end Handle;

   end Alarm_Handler;

   function Address_Word (Place : System.Address) return Word is (Word (To_Integer (Place)));

   Enable_Alarm : constant Word := Address_Word (Chip.Alarm.Enable'Address);

   --  The event of channel 2 has happened and stays; enabling it requests the interrupt at once.
   procedure Raise_Event is
      Event_Count  : constant Word := 10;
      Passed_Count : constant Word := 20;
   begin
      Chip.Alarm.Disable := Chip.Compare_Event;
      Chip.Alarm.Mode := Chip.Free_Running;
      Chip.Alarm.Compare := Event_Count;
      Chip.Alarm.Control := Chip.Start_Counting;
      while Chip.Alarm.Value < Passed_Count loop
         null;
      end loop;
   end Raise_Event;

   --  Delays of a request, seen in the interrupt controller

   Most_Operations : constant := 40;

   --  How many operations are executed between Trigger and the load that sees the request.
   --  Another interrupt can only make it fewer, so the largest of several counts.
   generic
      with procedure Set_Up;
      Trigger  : Word;
      Value    : Word;
      Withdraw : Word;
   function Operations_Until_Request return Integer;

   function Operations_Until_Request return Integer is
      Attempts : constant := 3;
      Largest  : Integer := 0;
      Needed   : Integer;
   begin
      for Attempt in 1 .. Attempts loop
         Needed := Most_Operations;
         for Count in reverse 0 .. Most_Operations - 1 loop
            Start_Over;
            Add (Zero_R12);
            Add (Store);
            Add (No_Operation, Count);
            Add (Load_Request);
            Add (Withdraw);
            Add_Return;
            Link_Timing.Await_Quiet;
            Set_Up;
            exit when not Has (Run (Code'Address, ARM, Trigger, Value).Result, Interrupt_Requested);
            Needed := Count;
         end loop;
         Largest := Integer'Max (Largest, Needed);
      end loop;
      return Largest;
   end Operations_Until_Request;

   function Until_Alarm_Request is new Operations_Until_Request
     (Set_Up   => Raise_Event,
      Trigger  => Enable_Alarm,
      Value    => Chip.Compare_Event,
      Withdraw => Store_Next);

   --  A digital line of port 3, where nothing is plugged in
   Pin : constant Word := Bit (Digital_0 (Sensor_3));

   procedure Lower_Pin is
      Discarded : Word;
   begin
      Chip.PIO_Interrupt_Off := Pin;
      PIOA.PIO_PER := Pin;
      PIOA.PIO_OER := Pin;
      PIOA.PIO_CODR := Pin;
      for Read in 1 .. 10 loop
         Discarded := PIOA.PIO_ISR;
      end loop;
      PIOA.PIO_IER := Pin;
      pragma Unreferenced (Discarded);
   end Lower_Pin;

   function Until_Pin_Request is new Operations_Until_Request
     (Set_Up   => Lower_Pin,
      Trigger  => Address_Word (PIOA.PIO_SODR'Address),
      Value    => Pin,
      Withdraw => Load_Pin_Edges);

   procedure Measure_Requests is
      Level_Mode : constant Word := Chip.AIC_Source_Mode (TC2_Id);
   begin
      Results.Put ("interrupt.level_request", Until_Alarm_Request, Cycles);
      Chip.AIC_Source_Mode (TC2_Id) := Level_Mode or Chip.Edge_Triggered;
      Results.Put ("interrupt.edge_request", Until_Alarm_Request, Cycles);
      Chip.AIC_Source_Mode (TC2_Id) := Level_Mode;
      Results.Put ("interrupt.pin_request", Until_Pin_Request, Cycles);
      PIOA.PIO_IFER := Pin;
      Results.Put ("interrupt.filtered_pin_request", Until_Pin_Request, Cycles);
      Chip.PIO_Filter_Off := Pin;
      Chip.PIO_Interrupt_Off := Pin;
      PIOA.PIO_ODR := Pin;
   end Measure_Requests;

   --  From the sequence that was made to the handler, in thousandths of a cycle
   function Cycles_To_Handler return Integer is
      Counter_Range : constant Word := 2 ** 16;
      Batches       : constant := 4;
      Counts        : Word := 0;
      Start         : Word;
   begin
      for Batch in 1 .. Batches loop
         Link_Timing.Await_Quiet;
         for Late in Skew loop
            Raise_Event;
            Start := Run (Code'Address, ARM, Enable_Alarm, Chip.Compare_Event, Late).Result;
            Counts := Counts + (Handled_At - Start) mod Counter_Range;
         end loop;
      end loop;
      return Integer (Counts) * 2_000 / (Batches * (Integer (Skew'Last) + 1));
   end Cycles_To_Handler;

   --  A request that waits while interrupts are masked; Next follows their unmasking.
   procedure Make_Unmasking (Next : Word) is
      Settled : constant := 20;
   begin
      Start_Over;
      Add (Store);
      Add (No_Operation, Settled);
      Add (Unmask);
      Add (Next);
      Add (No_Operation, Settled);
      Add (Keep_Start);
      Add_Return;
   end Make_Unmasking;

   procedure Measure_Handler is
      Longer_Than_Any : constant := 40;
   begin
      Start_Over;
      Add (Unmask);
      Add (No_Operation, 8);
      Add (Store);
      Add (No_Operation, Longer_Than_Any);
      Add (Keep_Start);
      Add_Return;
      Results.Put_Thousandths ("interrupt.handler", Cycles_To_Handler, Cycles);
      Make_Unmasking (No_Operation);
      Results.Put_Thousandths ("interrupt.unmasked", Cycles_To_Handler, Cycles);
      Make_Unmasking (Load_Four);
      Results.Put_Thousandths ("interrupt.unmasked_before_load", Cycles_To_Handler, Cycles);
   end Measure_Handler;

   --  The processor counts while the DMA controller sends bytes to the display, which takes them
   --  as commands without effect.

   Bytes     : constant := 100;
   No_Effect : constant := 16#E3#;
   type Byte is mod 2 ** 8;
   Commands  : array (1 .. Bytes) of Byte := (others => No_Effect) with Volatile;

   procedure Fill_DMA (Length : Word) is
   begin
      SPI.SPI.PERIPH_PTCR := SPI.DMA_Transmit_Disable;
      SPI.SPI.PERIPH_TPR := Commands'Address;
      SPI.SPI.PERIPH_TCR := Length;
   end Fill_DMA;

   function Cycles_Of_Loop return Integer is
     (Integer
        (Run
           (Code'Address, ARM,
            Address_Word (SPI.SPI.PERIPH_PTCR'Address), SPI.DMA_Transmit_Enable).Cycles));

   procedure Await_Sent is
   begin
      while not Has (SPI.SPI.SPI_SR, SPI.DMA_Ended)
        or else not Has (SPI.SPI.SPI_SR, SPI.Nothing_Left)
      loop
         null;
      end loop;
   end Await_Sent;

   procedure Measure_DMA is
      Counter_Range : constant Word := 2 ** 16;
      Start         : Word;
   begin
      Start_Over;
      Add (Store);
      Add (Load_Count);
      Add (Count_Down);
      Add (Loop_To_Count);
      Add_Return;
      PIOA.PIO_CODR := Bit (Display_Data);
      Link_Timing.Await_Quiet;
      Fill_DMA (0);
      Results.Put ("dma.loop_alone", Cycles_Of_Loop, Cycles);
      Link_Timing.Await_Quiet;
      Fill_DMA (Bytes);
      Results.Put ("dma.loop_beside_100_transfers", Cycles_Of_Loop, Cycles);
      Await_Sent;
      Link_Timing.Await_Quiet;
      Fill_DMA (Bytes);
      Start := Chip.Stopwatch.Value;
      SPI.SPI.PERIPH_PTCR := SPI.DMA_Transmit_Enable;
      Await_Sent;
      Results.Put
        ("display.100_bytes",
         2 * Integer ((Chip.Stopwatch.Value - Start) mod Counter_Range), Cycles);
   end Measure_DMA;

   procedure Measure is
   begin
      Measure_Requests;
      Measure_Handler;
      Measure_DMA;
   end Measure;

end Interrupt_Timing;
