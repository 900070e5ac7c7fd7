--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The chip's own converter, shared by all who use one of its channels. A conversion of all
--  channels in use takes at most 45 us and nothing waits for it: who has started one reads the
--  counts later.

with NXT.Registers.ADC;

private package NXT.Converter is

   subtype Channel is Registers.ADC.Channel;

   procedure Use_Channel (Number : Channel);
   procedure Release_Channel (Number : Channel);

   procedure Start;
   --  Convert the channels in use, unless a conversion runs.

   function Count (Number : Channel) return ADC_Value;
   --  Of the last conversion; 3.3 V is 1023.

end NXT.Converter;
