--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What happens when an exception has no handler: the motors brake and the display shows where the
--  program failed and in which task or handler, of a ceiling violation also the ceiling and an
--  address in the object, which the linker's map names. Every package that can move a motor or draw
--  brings this one into the program; the run-time calls it by the name of its symbol.

with System;

package NXT.Last_Chance is

   procedure Stop_And_Report (Source : System.Address; Line : Integer) with
     Export, Convention => C, External_Name => "ravenbrick_last_chance_hook";
   --  Source is a file name or a message and ends in NUL. Line is the line in the file; 0 when
   --  Source says all; or the address of the instruction, when the processor raised the exception.
   --  To be called with interrupts masked; uses neither interrupts nor the clock nor any state of
   --  the other drivers, and returns within 0.1 s.

end NXT.Last_Chance;
