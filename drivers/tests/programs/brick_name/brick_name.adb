--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Shows the brick's name, gives it a new one, and goes to the boot monitor.

with Ada.Real_Time;   use Ada.Real_Time;
with NXT.AVR;
with NXT.Brick_Name;  use NXT.Brick_Name;
with NXT.Display;     use NXT.Display;
with NXT.Parameters;
with NXT.Power;

procedure Brick_Name is
   Result : NXT.Parameters.Save_Result;
begin
   Put_Line (Name);
   Set_Name ("brick number 7!", Result);
   Put_Line (if NXT.Parameters."=" (Result, NXT.Parameters.Saved) then Name else "failed");
   NXT.AVR.Await_Data_Available;
   delay until Clock + Milliseconds (300);
   NXT.Power.Enter_Boot_Monitor;
   delay until Time_Last;
end Brick_Name;
