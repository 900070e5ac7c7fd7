--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Queue;
pragma Unreferenced (Queue);

procedure Second_Waiter with Priority => 1 is
begin
   null;
end Second_Waiter;
