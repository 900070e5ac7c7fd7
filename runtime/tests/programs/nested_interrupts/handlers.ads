--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A slow handler of a low level during which the timer of a high level rings, and the reverse

with System;

package Handlers is

   Low_Level  : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 2;
   High_Level : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 5;

   task Starter with Priority => 10, Storage_Size => 768;
   task Server with Priority => 20, Storage_Size => 768;

end Handlers;
