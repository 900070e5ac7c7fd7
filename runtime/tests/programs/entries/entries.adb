--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Rendezvous_Free;
pragma Unreferenced (Rendezvous_Free);

procedure Entries with Priority => 1 is
begin
   null;
end Entries;
