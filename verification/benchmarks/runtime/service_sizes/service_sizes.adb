--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Service_Uses;
pragma Unreferenced (Service_Uses);

procedure Service_Sizes is
begin
   null;
end Service_Sizes;
