--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Devices.Kinds is

   type Short is new Device with null record;
   overriding procedure Start (This : in out Short);

   package Nested is
      type Long is new Short with null record;
      overriding procedure Start (This : in out Long)
        with Export, Convention => Ada, External_Name => "a_name_of_its_own";
   end Nested;

   type Longest is new Nested.Long with null record;
   --  Inherits over two levels

   type Slow is new Meter with null record;
   overriding procedure Read (This : in out Slow);

   type Lamp is new Meter and Signal with null record;
   overriding procedure Read (This : in out Lamp);
   overriding procedure Send (This : in out Lamp);

   A_Short   : aliased Short;
   A_Longest : aliased Longest;
   A_Slow    : aliased Slow;
   A_Lamp    : aliased Lamp;

   This_Device : Any_Device := A_Short'Access;
   This_Meter  : Any_Meter := A_Lamp'Access;
   This_Signal : Any_Signal := A_Lamp'Access;

end Devices.Kinds;
