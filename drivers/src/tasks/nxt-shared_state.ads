--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A value that one task writes and others read, always as a whole: a protected object.

with System;

generic
   type State is private;
   Ceiling : System.Priority;
   --  The highest priority of the tasks that use it.
package NXT.Shared_State with Preelaborate is

   procedure Set (Now : State);

   function Get return State;
   --  The last value set; before that, the default of its type.

end NXT.Shared_State;
