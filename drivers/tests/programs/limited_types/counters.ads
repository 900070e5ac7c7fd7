--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Restrictions (No_Tagged_Type_Registration);

package Counters is

   type Counter (<>) is tagged limited private;

   function Make (Start : Integer) return Counter;

   procedure Add (This : in out Counter; Other : Counter);

   function Value (This : Counter) return Integer;

private

   type Counter is tagged limited record
      Count : Integer;
   end record;

end Counters;
