--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with Ravenbrick.Interrupts;
with Ravenbrick.Registers; use Ravenbrick.Registers;

package body Ravenbrick.Watchdog is

   Run : constant Word := 16#0005_0020#;
   --  RTT_MR: RTTRST, ALMIEN, prescaler 32, a step of 0.98 ms at 32.768 kHz

   Steps : constant Word := 50;
   --  RTT_AR: the alarm comes one step after the value (14.3)

   Feed : constant Word := 16#A500_0001#;
   --  WDT_CR: KEY, WDRSTT

   Cause_Mask  : constant Word := 16#700#;
   By_Watchdog : constant Word := 16#200#;
   --  RSTC_SR: RSTTYP

   Request : constant Word := 2 ** Natural (System_Id);

   procedure Arm is
   begin
      if not Interrupts.Is_Attached (System_Id) then
         RTT.RTT_AR := Steps - 1;
         RTT.RTT_MR := Run;
         AIC.AIC_SMR (System_Id) := 0;
         AIC.AIC_FFER := Request;
         AIC.AIC_IECR := Request;
      end if;
   end Arm;

   procedure Restart is
   begin
      RTT.RTT_MR := Run;
      WDT_CR := Feed;
   end Restart;

   function Was_Reset return Boolean is ((RSTC_SR and Cause_Mask) = By_Watchdog);

end Ravenbrick.Watchdog;
