--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Who failed, in words for a display. For the application's hook: what calls nothing here does
--  not have it in its image.

package Ravenbrick.Failures.Context is

   Longest : constant := 24;

   type Line_Number is range 1 .. 4;

   type Line is record
      Length : Natural range 0 .. Longest := 0;
      Text   : String (1 .. Longest);
   end record;

   function Describe (Number : Line_Number) return Line
     with Pre => System."/=" (Latest.Text, System.Null_Address);
   --  Of Failures.Latest: 1 "task NAME", or "task 00203A40" with the address of its control block
   --  when it has no name, "interrupt 12" in a handler; 2 "priority 12", the task's base priority.
   --  Of a ceiling violation, also 3 "ceiling 10" and 4 "object 00204B58", an address in
   --  it. Empty where there is nothing to say.

end Ravenbrick.Failures.Context;
