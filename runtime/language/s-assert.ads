--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Failed assertions: pragma Assert and the contracts that Assertion_Policy (Check) or the
--  compiler's option -gnata enables

package System.Assertions is
   pragma Preelaborate;

   Assert_Failure : exception;

   procedure Raise_Assert_Failure (Msg : String) with No_Return;
   --  Call the last-chance handler with the file and the line at the end of the compiler's
   --  message, or with the programmer's message and line 0

end System.Assertions;
