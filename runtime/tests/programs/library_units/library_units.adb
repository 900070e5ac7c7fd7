--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Units of the language's library that need no heap: pools, functions, images, packed arrays,
--  strings of C; atomic objects

with Ada.Numerics.Elementary_Functions; use Ada.Numerics.Elementary_Functions;
with Ada.Real_Time;                     use Ada.Real_Time;
with Ada.Unchecked_Deallocation;

with Interfaces.C; use Interfaces.C;

with Arenas;
use type Arenas.Bytes;
with Journal;

procedure Library_Units is

   Results : array (1 .. 6) of Integer := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "results";

   procedure Check (Holds : Boolean; Mark : Character);

   procedure Check (Holds : Boolean; Mark : Character) is
   begin
      Journal.Note (if Holds then Mark else '!');
   end Check;

   procedure Pools;
   procedure Functions;
   procedure Images;
   procedure Shared;

   procedure Pools is
      type Node is record
         Value : Integer;
         Next  : Integer;
      end record;
      type Node_Access is access Node with Storage_Size => 2 * Node'Size / 8;
      procedure Free is new Ada.Unchecked_Deallocation (Node, Node_Access);
      First  : Node_Access := new Node'(1, 2);
      Second : constant Node_Access := new Node'(3, 4);
      Third  : Node_Access;

      Pool : Arenas.Arena (64);
      type Word_Access is access Integer with Storage_Pool => Pool;
      Words : array (1 .. 16) of Word_Access;
   begin
      Free (First);
      Third := new Node'(5, 6);
      Check (Third.Value = 5 and then Second.Value = 3 and then First = null, 'a');
      for Index in Words'Range loop
         Words (Index) := new Integer'(Index);
      end loop;
      Check ((for all Index in Words'Range => Words (Index).all = Index), 'b');
      Check (Arenas.Used (Pool) = 64, 'c');
   end Pools;

   procedure Functions is
      Angle : Float := 0.5 with Volatile;
      Start : Time;
      Sum   : Float := 0.0;
   begin
      Results (1) := Integer (1.0E6 * Sin (Angle));
      Results (2) := Integer (1.0E6 * Exp (Angle));
      Results (3) := Integer (1.0E6 * Arctan (Angle, 2.0));
      Results (4) := Integer (1.0E6 * Angle ** 1.5);
      Start := Clock;
      for Count in 1 .. 100 loop
         Sum := Sum + Sin (Angle);
      end loop;
      Results (5) := (Clock - Start) / Tick * 16 / 100;
      Results (6) := Integer (1.0E4 * Sum);
   end Functions;

   procedure Images is
      type Colour is (Red, Green, Blue);
      type Centivolts is delta 0.01 range -100.0 .. 100.0;
      type Level is mod 8;
      type Levels is array (1 .. 10) of Level with Pack;
      Packed : Levels := (others => 5);
      Number : Integer := 42 with Volatile;
      Hue    : Colour := Green with Volatile;
      Volt   : Centivolts := 7.25 with Volatile;
      Volts  : Float := -7.25 with Volatile;
   begin
      Check (Number'Image = " 42" and then Integer'Value ("16#2A#") = Number, 'd');
      Check (Hue'Image = "GREEN" and then Colour'Value ("blue") = Blue, 'e');
      Check (Volt'Image = " 7.25" and then Centivolts'Value ("-0.50") = -0.5, 'f');
      Packed (3) := Packed (2) + 1;
      Check (Packed (3) = 6 and then Packed (4) = 5 and then Packed'Size <= 32, 'g');
      Check (Volts'Image = "-7.25000E+00" and then Float'Value ("1.5E1") = 15.0, 'h');
   end Images;

   type Cells is array (1 .. 4) of Short_Short_Integer with Atomic_Components;
   Neighbours : Cells := (others => -1);
   Whole      : Integer := 0 with Atomic;

   procedure Shared is
      Name : constant char_array := To_C ("brick");
   begin
      Neighbours (2) := 5;
      Whole := Whole + 1;
      Check (Neighbours = (-1, 5, -1, -1) and then Whole = 1, 'i');
      Check (Name'Length = 6 and then Name (Name'Last) = nul and then To_Ada (Name) = "brick", 'j');
   end Shared;

begin
   Pools;
   Functions;
   Images;
   Shared;
end Library_Units;
