--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The suite's interrupt, requested by software: the interrupt controller sets a source that is
--  sensitive to edges when its bit is written to the set command register (datasheet 23.7.1.4)

with System.Storage_Elements; use System.Storage_Elements;

package body ImpDef.Annex_C is

   type Word is mod 2 ** 32;

   Source : constant Natural := Natural (Interrupt_To_Generate);

   Source_Mode : Word
     with Volatile, Import, Address => To_Address (16#FFFF_F000# + 4 * Integer_Address (Source));
   Set_Command : Word with Volatile, Import, Address => To_Address (16#FFFF_F12C#);

   Positive_Edge : constant Word := 2#010_0000#;

   procedure Enable_Interrupts is null;

   procedure Generate_Interrupt is
   begin
      Source_Mode := Source_Mode or Positive_Edge;
      Set_Command := 2 ** Source;
   end Generate_Interrupt;

end ImpDef.Annex_C;
