--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task inside an object whose ceiling is an interrupt priority: handlers up to that priority
--  wait until it leaves, handlers above do not

with System;

package Masked is

   Low_Level  : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 2;
   High_Level : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 5;

   task User with Priority => 10, Storage_Size => 768;

end Masked;
