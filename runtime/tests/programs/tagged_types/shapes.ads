--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A library-level hierarchy with dispatching calls and an interface

package Shapes is

   type Measurable is limited interface;
   function Area (This : Measurable) return Natural is abstract;

   type Shape is abstract limited new Measurable with null record;
   function Scaled (This : Shape'Class) return Natural;

   type Square is limited new Shape with record
      Side : Natural := 0;
   end record;
   overriding function Area (This : Square) return Natural;

   type Oblong is limited new Square with record
      Other : Natural := 0;
   end record;
   overriding function Area (This : Oblong) return Natural;

end Shapes;
