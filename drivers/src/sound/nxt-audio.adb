--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with NXT.Priorities;
with NXT.Registers.PIO;     use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.SSC;     use NXT.Registers.SSC;
with System.Storage_Elements;

package body NXT.Audio is

   Controller : Registers.SSC.Peripheral renames Registers.SSC.SSC;

   Speaker : constant Word := Bit (Sound_Output);

   --  Bits leave at the master clock divided by twice the divider, 32 bits per sample.
   Halves_Per_Sample : constant := 2 * Bits_Per_Word;
   Tone_Divider      : constant := 24;
   pragma Compile_Time_Error
     (Tone_Rate /= Clock_Frequency / Halves_Per_Sample / Tone_Divider, "rate of tones");

   Samples_Per_Buffer : constant := 16;
   type Sample_Buffer is array (1 .. Samples_Per_Buffer) of Word;
   type Buffer_Id is mod 2;

   --  A sample is the number of ones in a word, and what is left over goes to the next one.
   type Level is range 0 .. Bits_Per_Word;
   Steps : constant := 256;

   function Spread (Ones : Level) return Word;
   --  A word with so many ones, as even as can be.

   function Spread (Ones : Level) return Word is
      Sum : Natural := Bits_Per_Word / 2;
   begin
      return Pattern : Word := 0 do
         for Place in 1 .. Bits_Per_Word loop
            Pattern := 2 * Pattern;
            Sum := Sum + Natural (Ones);
            if Sum >= Bits_Per_Word then
               Sum := Sum - Bits_Per_Word;
               Pattern := Pattern + 1;
            end if;
         end loop;
      end return;
   end Spread;

   Patterns : array (Level) of Word;

   --  Sent first, twice, so that all samples are made by the interrupt and the caller, who holds
   --  it back, makes none. Long enough for a buffer to be filled meanwhile.
   Lead_Samples : constant := 4;
   Lead : constant array (1 .. Lead_Samples) of Word := (others => 16#5555_5555#);

   type Source is record
      Is_Tone : Boolean := True;
      Left    : Unsigned_32 := 0;
      Phase   : Unsigned_32 := 0;
      Step    : Unsigned_32 := 0;
      Input   : System.Address := System.Null_Address;
      Volume  : Allowed_Volume := 0;
      Rate    : Unsigned_32 := Tone_Rate;
   end record;
   --  Left: samples. Phase: 2**32 to a period.

   --  A sine made of two parabolas, within 128
   function Wave (Phase : Unsigned_32) return Integer is
      Half  : constant := 128;
      Place : constant Integer := Integer (Shift_Right (Phase, 24));
      Along : constant Integer := Place mod Half;
      Height : constant Integer := Along * (Half - Along) / 32;
   begin
      return (if Place < Half then Height else -Height);
   end Wave;

   procedure Take (From : in out Source; Sample : out Integer) is
      use System.Storage_Elements;
   begin
      if From.Left = 0 then
         Sample := 0;
         return;
      end if;
      From.Left := From.Left - 1;
      if From.Is_Tone then
         Sample := Wave (From.Phase);
         From.Phase := From.Phase + From.Step;
      else
         declare
            Value : Unsigned_8 with Import, Address => From.Input;
         begin
            Sample := Integer (Value) - 128;
         end;
         From.Input := From.Input + 1;
      end if;
      Sample := Sample * From.Volume / Maximum_Volume;
   end Take;

   Buffers : array (Buffer_Id) of Sample_Buffer;
   --  One is sent while the other is filled.

   protected Player with Interrupt_Priority => Priorities.Audio_Interrupt is
      procedure Start (What : Source; Divider : Word);
      procedure Set_Muted (Now : Boolean);
      procedure Stop;
      function Samples_Left return Unsigned_32;
      function Rate return Unsigned_32;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.SSC;
      procedure Fill (Buffer : Buffer_Id);
      procedure Connect;
      Now_Playing : Source;
      Left_Over   : Natural := 0;
      Next        : Buffer_Id := 0;
      Playing     : Boolean := False;
      Muted       : Boolean := False;
      Queued      : Unsigned_32 := 0;
   end Player;
   --  Queued: samples in buffers, which are not sent yet.

   protected body Player is

      procedure Connect is
      begin
         if Playing and then not Muted then
            PIOA.PIO_PDR := Speaker;
         else
            PIOA.PIO_PER := Speaker;
         end if;
      end Connect;

      procedure Stop is
      begin
         Controller.SSC_IDR := DMA_Ended or DMA_Drained;
         Controller.PERIPH_PTCR := DMA_Transmit_Disable;
         Controller.PERIPH_TNCR := 0;
         Controller.PERIPH_TCR := 0;
         Controller.SSC_CR := Transmit_Disable;
         Playing := False;
         Queued := 0;
         Connect;
      end Stop;

      procedure Fill (Buffer : Buffer_Id) is
         Sample, Sum : Integer;
      begin
         for Item of Buffers (Buffer) loop
            pragma Annotate (Ravenbrick, Iterations, 16, "Samples_Per_Buffer");
            Take (Now_Playing, Sample);
            Sum := Left_Over + (Sample + 128) * Bits_Per_Word;
            Item := Patterns (Level (Sum / Steps));
            Left_Over := Sum mod Steps;
         end loop;
      end Fill;

      procedure Start (What : Source; Divider : Word) is
      begin
         Stop;
         Now_Playing := What;
         Next := 0;
         Playing := True;
         Controller.SSC_CMR := Divider;
         Controller.PERIPH_TPR := Lead'Address;
         Controller.PERIPH_TCR := Lead_Samples;
         Controller.PERIPH_TNPR := Lead'Address;
         Controller.PERIPH_TNCR := Lead_Samples;
         Controller.SSC_CR := Transmit_Enable;
         Controller.PERIPH_PTCR := DMA_Transmit_Enable;
         Controller.SSC_IER := DMA_Ended;
         Connect;
      end Start;

      procedure Set_Muted (Now : Boolean) is
      begin
         Muted := Now;
         Connect;
      end Set_Muted;

      function Samples_Left return Unsigned_32 is
        (if Playing then Now_Playing.Left + Queued else 0);

      function Rate return Unsigned_32 is (Now_Playing.Rate);

      --  A buffer has been sent and the other one is being sent.
      procedure Handle_Interrupt is
      begin
         if Has (Controller.SSC_SR, DMA_Drained) then
            Stop;
         elsif Now_Playing.Left = 0 then
            Controller.SSC_IDR := DMA_Ended;
            Controller.SSC_IER := DMA_Drained;
            Queued := Samples_Per_Buffer;
         else
            Fill (Next);
            Controller.PERIPH_TNPR := Buffers (Next)'Address;
            Controller.PERIPH_TNCR := Samples_Per_Buffer;
            Next := Next + 1;
            Queued := 2 * Samples_Per_Buffer;
         end if;
      end Handle_Interrupt;

   end Player;

   procedure Mute is
   begin
      Player.Set_Muted (True);
   end Mute;

   procedure Unmute is
   begin
      Player.Set_Muted (False);
   end Unmute;

   procedure Play_Tone (Frequency : Unsigned_32; Interval : Unsigned_32; Volume : Allowed_Volume)
   is
      Period : constant := 2 ** 32;
      Per_Second : constant := 1_000;
      Steps_Per_Hertz : constant := Period / Tone_Rate;
   begin
      Player.Start
        ((Is_Tone => True,
          Left    => Unsigned_32
            (Unsigned_64 (Interval) * Tone_Rate / Per_Second),
          Step    => Frequency * Steps_Per_Hertz,
          Volume  => Volume,
          Rate    => Tone_Rate,
          others  => <>),
         Tone_Divider);
   end Play_Tone;

   procedure Play_Sample
     (Input        : System.Address;
      Input_Length : Unsigned_32;
      Volume       : Allowed_Volume;
      Rate         : Sampling_Rates := Default_Rate)
   is
      Halves : constant Unsigned_32 := Halves_Per_Sample * Rate;
   begin
      Player.Start
        ((Is_Tone => False,
          Left    => Input_Length,
          Input   => Input,
          Volume  => Volume,
          Rate    => Rate,
          others  => <>),
         (Clock_Frequency + Halves / 2) / Halves);
   end Play_Sample;

   procedure Stop is
   begin
      Player.Stop;
   end Stop;

   function Time_Remaining return Integer is
     (Integer (Unsigned_64 (Player.Samples_Left) * 1_000 / Unsigned_64 (Player.Rate)));

begin
   for Ones in Level loop
      Patterns (Ones) := Spread (Ones);
   end loop;
   PMC.PMC.PMC_PCER := Bit (SSC_Id) or Bit (PIOA_Id);
   PIOA.PIO_CODR := Speaker;
   PIOA.PIO_OER := Speaker;
   PIOA.PIO_PER := Speaker;
   PIOA.PIO_ASR := Speaker;
   Controller.SSC_CR := Reset;
   Controller.SSC_TFMR := Sound_Words;
end NXT.Audio;
