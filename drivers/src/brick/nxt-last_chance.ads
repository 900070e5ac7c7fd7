--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What happens when an exception has no handler: the motors brake and the display shows where the
--  program failed and in which task or handler, of a ceiling violation also the ceiling and an
--  address in the object, which the linker's map names. Then the power button, held for 3 s,
--  switches the brick off. Every package that can move a motor or draw brings this one into the
--  program; the run-time calls both procedures by the names of their symbols.

with System;

package NXT.Last_Chance is

   procedure Stop_And_Report (Source : System.Address; Line : Integer) with
     Export, Convention => C, External_Name => "ravenbrick_last_chance_hook";
   --  Source is a file name or a message and ends in NUL. Line is the line in the file; 0 when
   --  Source says all; or the address of the instruction, when the processor raised the exception.
   --  To be called with interrupts masked; uses neither interrupts nor the clock nor any state of
   --  the other drivers, and returns within 0.1 s.

   procedure Await_Power_Button with
     Export, Convention => C, External_Name => "ravenbrick_failed_program_hook", No_Return;
   --  Keep the motors braked and exchange frames with the co-processor until NXT.Forced_Power_Off
   --  wants the brick off, then command that for as long as there is a supply. To be called after
   --  Stop_And_Report, with interrupts masked.

end NXT.Last_Chance;
