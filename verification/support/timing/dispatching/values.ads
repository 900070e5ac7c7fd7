--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Devices;

package Values is

   type Value is tagged record
      Size : Natural := 0;
   end record;
   function Made return Value;
   procedure Take (This : in out Value; From : Value);

   type Any_Value is access all Value'Class;

   type Wide is new Value with null record;
   overriding function Made return Wide;
   overriding procedure Take (This : in out Wide; From : Wide);

   protected type Guard with Priority => 20 is new Devices.Signal with
      overriding procedure Send;
   private
      Count : Natural := 0;
   end Guard;

   A_Value : aliased Value;
   A_Wide  : aliased Wide;
   A_Guard : aliased Guard;

   This_Value  : Any_Value := A_Value'Access;
   That_Signal : Devices.Any_Signal := A_Guard'Access;

end Values;
