--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Fails in the way and in the task that a test writes into the image.

package Failing is

   type Way is
     (Nothing, Recursion, Deep_Calls, Large_Array, Sized_Array, Range_Check, Index_Check, Overflow,
      Division, Raised, Raised_With_Message, Own_Exception, Storage, Assertion, No_Memory,
      Misaligned, Undefined, Wild_Jump, In_Protected, Ceiling, In_Handler, Handler_Recursion,
      Read_Early, Drive);

   The_Task : Integer := 1 with Volatile, Export, Convention => C, External_Name => "failing_task";
   Chosen   : Integer := 1 with Volatile, Export, Convention => C, External_Name => "failing_way";
   Amount   : Integer := 1
     with Volatile, Export, Convention => C, External_Name => "failing_amount";

   procedure Go (Called_By : Integer);
   --  Fail if Called_By is The_Task.

   Too_Hot : exception;

end Failing;
