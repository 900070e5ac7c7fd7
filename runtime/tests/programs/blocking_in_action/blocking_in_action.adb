--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Blocking_Object;
pragma Unreferenced (Blocking_Object);

procedure Blocking_In_Action with Priority => 1 is
begin
   null;
end Blocking_In_Action;
