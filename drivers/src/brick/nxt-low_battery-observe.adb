--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Configuration;
with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with Ravenbrick.Failures;

procedure NXT.Low_Battery.Observe (Low_Inputs : in out Input_Count; Values : AVR_IO.Inputs) is

   --  6.5 V, without which LEGO's co-processor does not start with the pack; 4.8 V of six cells,
   --  0.8 V each, where makers end their discharge curves (Energizer, data sheet of the E91).
   Good  : constant ADC_Value :=
     (if Values.Rechargeable then 6_500_000 / 13_848 else 4_800_000 / 13_848);
   Empty : constant Boolean := Values.Battery_Count < Good;

   Inputs_Per_Second : constant := 1_000 / (2 * Configuration.Link_Period_Ms);
   Silent_Inputs     : constant := 800 / (2 * Configuration.Link_Period_Ms);

   Speaker       : constant Word := 2 ** Sound_Output;
   Battery_Empty : constant String := "battery empty" & ASCII.NUL;

begin
   if Low_Inputs = 0 or else not Empty then
      Empty_Inputs := 0;
   end if;
   if Empty then
      Empty_Inputs := Empty_Inputs + 1;
      if Empty_Inputs > Inputs_Per_Second then
         Ravenbrick.Failures.Stop (Battery_Empty'Address);
      end if;
   end if;
   Low_Inputs := (if Low_Inputs < Inputs_Per_Second then Low_Inputs + 1 else 1);

   --  Changed with each input, the line hums with 125 Hz at the usual period of the link. While
   --  NXT.Audio plays, the line is not the controller's, and nothing is heard of this.
   if Low_Inputs > Silent_Inputs then
      PIOA.PIO_OER := Speaker;
      if Low_Inputs mod 2 = 0 then
         PIOA.PIO_CODR := Speaker;
      else
         PIOA.PIO_SODR := Speaker;
      end if;
   end if;
end NXT.Low_Battery.Observe;
