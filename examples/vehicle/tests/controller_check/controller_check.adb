--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Runs the check that the test generated in C

pragma Warnings (Off, "unit ""Controller_Parts"" is not referenced");
with Controller_Parts;

procedure Controller_Check is
   procedure Functional_Check
     with Import, Convention => C, External_Name => "functional_check";
begin
   Functional_Check;
end Controller_Check;
