--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Interfaces;    use Interfaces;

package body Workers is

   type Table is array (Slot) of Integer with Volatile_Components;

   Periods : Table := (others => 1_000_000) with
     Export, Convention => C, External_Name => "campaign_period_us";
   --  0: the task never runs

   Phases : Table := (others => 0) with
     Export, Convention => C, External_Name => "campaign_phase_us";

   Rounds : Table := (others => 1) with
     Export, Convention => C, External_Name => "campaign_rounds";

   Locked_Rounds : Table := (others => 1) with
     Export, Convention => C, External_Name => "campaign_locked_rounds";

   Sink : array (Slot) of Unsigned_32 := (others => 1) with Volatile_Components;

   Epoch : constant Time := Clock + Milliseconds (20);

   procedure Mix (Value : in out Unsigned_32) with Inline;

   procedure Mix (Value : in out Unsigned_32) is
   begin
      Value := Value xor Shift_Left (Value, 13);
      Value := Value xor Shift_Right (Value, 17);
      Value := Value xor Shift_Left (Value, 5);
   end Mix;

   protected Shared with Priority => 18 is
      procedure Hold (Count : Integer);
   private
      State : Unsigned_32 := 1;
   end Shared;

   protected body Shared is

      procedure Hold (Count : Integer) is
         Value : Unsigned_32 := State;
      begin
         for Round in 1 .. Count loop
            Mix (Value);
         end loop;
         State := Value;
      end Hold;

   end Shared;

   procedure Compute (Number : Slot) with No_Inline;

   procedure Compute (Number : Slot) is
      Value : Unsigned_32 := Sink (Number);
   begin
      for Round in 1 .. Rounds (Number) loop
         Mix (Value);
      end loop;
      Sink (Number) := Value;
   end Compute;

   task body Worker is
      Next   : Time :=
        (if Periods (Number) = 0 then Time_Last else Epoch + Microseconds (Phases (Number)));
      Period : constant Time_Span := Microseconds (Periods (Number));
   begin
      loop
         delay until Next;
         Compute (Number);
         Shared.Hold (Locked_Rounds (Number));
         Next := Next + Period;
      end loop;
   end Worker;

end Workers;
