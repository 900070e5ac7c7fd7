--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Motors.Simple.Ctors is

   function Make (Id : Motor_Id) return Simple_Motor is
   begin
      return (Port => Id, others => <>);
   end Make;

end NXT.Motors.Simple.Ctors;
