--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Counts how often the program was started, in the flash memory.

with Ada.Real_Time;   use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;     use NXT.Display;
with NXT.Parameters;  use NXT.Parameters;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure Storage is

   package Starts is new Store (Natural, Id => 1, Format => 1);

   Number : Natural := 0;
   Known  : Boolean;
   Result : Save_Result;
begin
   Starts.Load (Number, Known);
   Number := Number + 1;
   Starts.Save (Number, Result);
   Put_At (0, 0, (if Known then "once more" else "first start"));
   Put_At (0, 1, "starts");
   Set_Pos (7, 1);
   Put (Number, Width => 4);
   Put_At (0, 2, (if Result = Saved then "saved" else "not saved"));
   delay until Time_Last;
end Storage;
