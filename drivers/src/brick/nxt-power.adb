--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Flash_Pages;
with NXT.Registers.EFC;
with NXT.Registers.RSTC;  use NXT.Registers, NXT.Registers.RSTC;

package body NXT.Power is

   use type Word;

   function Last_Reset return Reset_Cause is
      Cause : constant Word := Registers.RSTC.RSTC.RSTC_SR / 2 ** Cause_Place and Cause_Mask;
   begin
      case Cause is
         when 2      => return Watchdog;
         when 3      => return Software;
         when 4      => return Reset_Pin;
         when 5      => return Brown_Out;
         when others => return Power_On;
      end case;
   end Last_Reset;

   procedure Reset_At_Brown_Out is
   begin
      Flash_Pages.Set_Bit (Registers.EFC.Reset_At_Brown_Out);
      Flash_Pages.Set_Bit (Registers.EFC.Detect_Brown_Out);
   end Reset_At_Brown_Out;

   procedure Switch_Off is
   begin
      NXT.AVR.Power_Down;
   end Switch_Off;

   procedure Enter_Boot_Monitor is
   begin
      NXT.AVR.Enter_Boot_Monitor;
   end Enter_Boot_Monitor;

end NXT.Power;
