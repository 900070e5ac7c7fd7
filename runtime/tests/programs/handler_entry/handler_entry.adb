--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Sporadic;
pragma Unreferenced (Sporadic);

procedure Handler_Entry with Priority => 1 is
begin
   null;
end Handler_Entry;
