--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Values is

   function Made return Value is (Size => 4);

   procedure Take (This : in out Value; From : Value) is
   begin
      This.Size := From.Size;
   end Take;

   function Made return Wide is
   begin
      Devices.Work (20);
      return (Size => 5);
   end Made;

   procedure Take (This : in out Wide; From : Wide) is
   begin
      Devices.Work (25);
      This.Size := From.Size;
   end Take;

   protected body Guard is
      procedure Send is
      begin
         Count := (Count + 1) mod 9;
         Devices.Work (45);
      end Send;
   end Guard;

end Values;
