--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Devices is

   procedure Work (Steps : Positive) is
   begin
      for Step in 1 .. Steps loop
         pragma Annotate (Ravenbrick, Iterations, 60, "no operation takes more");
         Work_Done := Step;
      end loop;
   end Work;

   procedure Run (This : in out Device'Class) is
   begin
      This.Start;
   end Run;

end Devices;
