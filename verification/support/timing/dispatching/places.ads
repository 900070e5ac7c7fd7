--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Devices;
with System;
with System.Storage_Elements; use System.Storage_Elements;

package Places is

   Place : System.Address := Devices.Work'Address with Volatile;

   type Table is array (0 .. 1) of Integer_Address with Volatile_Components;
   type Any_Table is access all Table;

   A_Table    : aliased Table := (others => To_Integer (Devices.Work'Address));
   This_Table : Any_Table := A_Table'Access with Volatile;

end Places;
