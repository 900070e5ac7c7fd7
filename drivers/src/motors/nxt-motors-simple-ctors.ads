--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  How simple motors come to be.

package NXT.Motors.Simple.Ctors is

   function Make (Id : Motor_Id) return Simple_Motor;
   --  The motor at a port, at full power as soon as it is made to move. It stays as it is.

end NXT.Motors.Simple.Ctors;
