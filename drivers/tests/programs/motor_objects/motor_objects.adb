--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors in the way of existing course programs; a change every 100 ms from 200 ms on.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Motors.Simple;        use NXT.Motors.Simple;
with NXT.Motors.Simple.Ctors;  use NXT.Motors.Simple.Ctors;

procedure Motor_Objects is

   use NXT;

   Engine : Simple_Motor := Make (Motor_B);
   Moving : Integer := 0 with Volatile, Export, Convention => C, External_Name => "moving";

   Next   : Time := NXT.AVR.First_Release;

   procedure Wait (Milliseconds_More : Positive) is
   begin
      Moving := Boolean'Pos (Engine.Moving);
      Next := Next + Milliseconds (Milliseconds_More);
      delay until Next;
   end Wait;

begin
   Wait (200);
   Engine.Set_Power (25);
   Engine.Forward;
   Wait (100);
   Engine.Reverse_Direction;
   Wait (100);
   Engine.Set_Power (60);
   Wait (100);
   Engine.Stop (Apply_Brake => True);
   Wait (100);
   Engine.Backward;
   Engine.Stop;
   Engine.Reverse_Direction;
   Wait (100);
   delay until Time_Last;
end Motor_Objects;
