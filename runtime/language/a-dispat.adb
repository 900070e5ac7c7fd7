--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;
with Ravenbrick.Processor;
with Ravenbrick.Threads;

package body Ada.Dispatching is

   procedure Yield is
      use Ravenbrick.Threads;
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Blocking'Address);
      end if;
      Ravenbrick.Processor.Mask_In_Thread;
      Yield (Self);
   end Yield;

end Ada.Dispatching;
