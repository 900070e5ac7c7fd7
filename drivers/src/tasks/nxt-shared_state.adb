--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Shared_State is

   protected Object with Priority => Ceiling is
      procedure Set (Now : State);
      function Get return State;
   private
      Current : State;
   end Object;

   protected body Object is

      procedure Set (Now : State) is
      begin
         Current := Now;
      end Set;

      function Get return State is (Current);

   end Object;

   procedure Set (Now : State) is
   begin
      Object.Set (Now);
   end Set;

   function Get return State is
   begin
      return Object.Get;
   end Get;

end NXT.Shared_State;
