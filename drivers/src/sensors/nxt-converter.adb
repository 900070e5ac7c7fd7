--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.PMC;  use NXT.Registers;

package body NXT.Converter is

   use type Word;

   Controller : Registers.ADC.Peripheral renames Registers.ADC.ADC;

   procedure Use_Channel (Number : Channel) is
   begin
      Controller.Enable_Channel := Bit (Number);
   end Use_Channel;

   procedure Release_Channel (Number : Channel) is
   begin
      Controller.Disable_Channel := Bit (Number);
   end Release_Channel;

   procedure Start is
   begin
      Controller.Control := Registers.ADC.Start;
   end Start;

   function Count (Number : Channel) return ADC_Value is
     (ADC_Value (Controller.Data (Number) mod 1024));

begin
   PMC.PMC.Enable_Clock := Bit (ADC_Id);
   Controller.Mode := Registers.ADC.Ten_Bits;
end NXT.Converter;
