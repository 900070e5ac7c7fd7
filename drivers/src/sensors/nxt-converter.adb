--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.PMC;  use NXT.Registers;

package body NXT.Converter is

   use type Word;

   Controller : Registers.ADC.Peripheral renames Registers.ADC.ADC;

   procedure Use_Channel (Number : Channel) is
   begin
      Controller.ADC_CHER := Bit (Number);
   end Use_Channel;

   procedure Release_Channel (Number : Channel) is
   begin
      Controller.ADC_CHDR := Bit (Number);
   end Release_Channel;

   procedure Start is
   begin
      Controller.ADC_CR := Registers.ADC.Start;
   end Start;

   function Count (Number : Channel) return ADC_Value is
     (ADC_Value (Controller.ADC_CDR (Number) mod 1024));

begin
   PMC.PMC.PMC_PCER := Bit (ADC_Id);
   Controller.ADC_MR := Registers.ADC.Ten_Bits;
end NXT.Converter;
