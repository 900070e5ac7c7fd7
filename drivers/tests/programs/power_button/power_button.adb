--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Everything in the way of the power button: the main procedure loops, one task is suspended for
--  ever, another drives motor B all the time. It also counts short presses of the button.

with Commanding;
pragma Unreferenced (Commanding);
with System;

procedure Power_Button with Priority => System.Priority'First is
begin
   loop
      null;
   end loop;
end Power_Button;
