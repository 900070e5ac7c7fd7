--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;                use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;
with Interfaces;                   use Interfaces;

package body Workers is

   Epoch : constant Time := Clock + Milliseconds (20);

   type Table is array (Unsigned_32 range 0 .. 63) of Unsigned_32 with Volatile_Components;
   type Operation_Access is access function (Value : Unsigned_32) return Unsigned_32;

   Values : Table := (others => 3);
   Length : Unsigned_32 := 5 with Volatile;
   Result : Unsigned_32 := 0 with Volatile;
   Cue    : Suspension_Object;

   function Sum (Count : Unsigned_32) return Unsigned_32 with No_Inline;
   function Depth_Of (Level : Unsigned_32) return Unsigned_32 with No_Inline;
   function Twice (Value : Unsigned_32) return Unsigned_32 with No_Inline;
   function Half (Value : Unsigned_32) return Unsigned_32 with No_Inline;
   function Apply (Value : Unsigned_32) return Unsigned_32 with No_Inline;
   procedure Seldom with No_Inline;
   procedure Refill with No_Inline;

   protected Store with Priority => 12 is
      procedure Fill;
   end Store;

   protected body Store is
      procedure Fill is
      begin
         for Item of Values loop
            Item := 3;
         end loop;
      end Fill;
   end Store;

   function Sum (Count : Unsigned_32) return Unsigned_32 is
      Total : Unsigned_32 := 0;
      Place : Unsigned_32 := 0;
   begin
      while Place < Count loop
         Total := Total + Values (Place);
         Place := Place + 1;
      end loop;
      return Total;
   end Sum;

   function Depth_Of (Level : Unsigned_32) return Unsigned_32 is
     (if Level = 0 then Values (0) else 1 + Depth_Of (Level - 1));

   function Twice (Value : Unsigned_32) return Unsigned_32 is (2 * Value);

   function Half (Value : Unsigned_32) return Unsigned_32 is (Value / 2);

   Operation : Operation_Access := Twice'Access with Volatile;

   function Apply (Value : Unsigned_32) return Unsigned_32 is (Operation (Value));

   procedure Seldom is
   begin
      Result := Values (1);
   end Seldom;

   procedure Refill is
   begin
      Store.Fill;
   end Refill;

   --  Every seventh job has the longest table; the listener is released by every third.
   task body Control is
      Next  : Time := Epoch;
      Count : Unsigned_32 := 0;
   begin
      loop
         delay until Next;
         Count := Count + 1;
         Length := (if Count mod 7 = 0 then 40 else 5);
         Result := Sum (Length) + Depth_Of (Values (2) + 7) + Apply (Count);
         if Count mod 3 = 0 then
            Set_True (Cue);
         end if;
         if Count = 100 then
            Operation := Half'Access;
            Seldom;
         end if;
         Next := Next + Milliseconds (4);
      end loop;
   end Control;

   task body Listener is
   begin
      loop
         Suspend_Until_True (Cue);
         Result := Values (3);
         if Length = 0 then
            Refill;
         end if;
      end loop;
   end Listener;

end Workers;
