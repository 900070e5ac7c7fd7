--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Parts;
pragma Unreferenced (Parts);

procedure Weighed is
begin
   null;
end Weighed;
