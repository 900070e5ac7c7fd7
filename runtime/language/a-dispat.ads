--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Giving way (Ada RM D.2.1). The profiles fix the policy, so that there is nothing else to choose.

package Ada.Dispatching is
   pragma Preelaborate;

   procedure Yield;
   --  Let the ready tasks of the caller's priority run first. Program_Error in a protected action.

   Dispatching_Policy_Error : exception;

end Ada.Dispatching;
