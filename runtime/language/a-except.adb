--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;

package body Ada.Exceptions is

   procedure Raise_Exception (E : Exception_Id; Message : String := "") is
      pragma Unreferenced (E);
   begin
      Ravenbrick.Failures.Stop_With (Message, Line => 0);
   end Raise_Exception;

end Ada.Exceptions;
