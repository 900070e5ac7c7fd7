--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Shapes is

   function Scaled (This : Shape'Class) return Natural is (10 * This.Area);

   overriding function Area (This : Square) return Natural is (This.Side ** 2);

   overriding function Area (This : Oblong) return Natural is (This.Side * This.Other);

end Shapes;
