--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time;        use Ada.Real_Time;

with Ravenbrick.Failures.Context; use Ravenbrick.Failures.Context;
with Timers;                      use Timers;

package body Culprits is

   function Is_Chosen (Item : Culprit) return Boolean is (Chosen = Culprit'Pos (Item));

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 3 is
      procedure Handle with Attach_Handler => TC1;
   end Source;

   procedure Hook (Message : System.Address; Line : Integer) is
      pragma Unreferenced (Message, Line);
   begin
      for Number in Line_Number loop
         declare
            Shown : constant Ravenbrick.Failures.Context.Line := Describe (Number);
            First : constant Positive := 1 + Longest * (Natural (Number) - 1);
         begin
            Described (First .. First + Shown.Length - 1) := Shown.Text (1 .. Shown.Length);
         end;
      end loop;
   end Hook;

   protected body Low is
      procedure Touch is null;
   end Low;

   protected body Source is
      procedure Handle is
      begin
         Acknowledge (Channel_1);
         raise Program_Error;
      end Handle;
   end Source;

   task body Pilot is
   begin
      delay until Clock + Milliseconds (1);
      if Is_Chosen (Pilot_Above_Ceiling) then
         Low.Touch;
      elsif Is_Chosen (Handler_Of_TC1) then
         Start_Once (Channel_1, 24_027);
      end if;
      delay until Time_Last;
   end Pilot;

   task body Nameless is
   begin
      delay until Clock + Milliseconds (2);
      if Is_Chosen (Nameless_Task) then
         raise Constraint_Error;
      end if;
      delay until Time_Last;
   end Nameless;

end Culprits;
