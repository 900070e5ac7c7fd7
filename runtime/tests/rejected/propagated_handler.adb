--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Exception_Propagation: only a handler that names a locally raised exception is allowed

procedure Propagated_Handler is
   procedure Fail is
   begin
      raise Constraint_Error;
   end Fail;
begin
   Fail;
exception
   when Occurrence : Constraint_Error =>
      raise Program_Error;
end Propagated_Handler;
