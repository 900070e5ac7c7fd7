--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Reset controller (datasheet, chapter RSTC).

with System;

package NXT.Registers.RSTC is

   type Peripheral is record
      RSTC_CR : Word with Atomic;  --  control
      RSTC_SR : Word with Atomic;  --  status
      RSTC_MR : Word with Atomic;  --  mode
   end record;

   RSTC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FD00#);

   --  RSTC_SR: the cause of the last reset in three bits
   Cause_Place : constant := 8;  --  RSTTYP
   Cause_Mask  : constant Word := 7;

end NXT.Registers.RSTC;
