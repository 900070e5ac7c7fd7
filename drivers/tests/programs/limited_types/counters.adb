--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Malloc;
pragma Unreferenced (NXT.Malloc);

package body Counters is

   function Make (Start : Integer) return Counter is
   begin
      return Result : Counter := (Count => 0) do
         Result.Count := Start;
      end return;
   end Make;

   procedure Add (This : in out Counter; Other : Counter) is
   begin
      This.Count := This.Count + Other.Count;
   end Add;

   function Value (This : Counter) return Integer is (This.Count);

end Counters;
