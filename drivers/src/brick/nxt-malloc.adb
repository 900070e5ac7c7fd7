--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Malloc is

   function Refuse (Bytes : Interfaces.Unsigned_32) return System.Address is
     (raise Storage_Error with "NXT.Malloc: there is no heap");

end NXT.Malloc;
