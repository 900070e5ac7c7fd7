--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Shapes; use Shapes;

procedure Tagged_Types with Priority => 1 is

   type Any_Shape is access constant Shape'Class;

   A : aliased constant Square := (Side => 3);
   B : aliased constant Oblong := (Side => 4, Other => 5);

   Both : constant array (1 .. 2) of Any_Shape := (A'Unchecked_Access, B'Unchecked_Access);

   Areas : array (1 .. 2) of Integer := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "areas";
   Kinds : array (1 .. 2) of Integer := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "kinds";

begin
   for Index in Both'Range loop
      Areas (Index) := Both (Index).Scaled;
      Kinds (Index) := (if Both (Index).all in Oblong'Class then 2 else 1);
   end loop;
end Tagged_Types;
