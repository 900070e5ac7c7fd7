--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Released;

procedure Delays with Priority => 1 is
begin
   Released.Be_Busy;
end Delays;
