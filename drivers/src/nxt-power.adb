--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Registers.RSTC;  use NXT.Registers, NXT.Registers.RSTC;

package body NXT.Power is

   use type Word;

   function Last_Reset return Reset_Cause is
      Cause : constant Word := Registers.RSTC.RSTC.Status / 2 ** Cause_Place and Cause_Mask;
   begin
      case Cause is
         when 2      => return Watchdog;
         when 3      => return Software;
         when 4      => return Reset_Pin;
         when 5      => return Brown_Out;
         when others => return Power_On;
      end case;
   end Last_Reset;

   procedure Switch_Off is
   begin
      NXT.AVR.Power_Down;
   end Switch_Off;

   procedure Enter_Boot_Monitor is
   begin
      NXT.AVR.Enter_Boot_Monitor;
   end Enter_Boot_Monitor;

end NXT.Power;
