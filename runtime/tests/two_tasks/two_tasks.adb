--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Work;

procedure Two_Tasks is
begin
   Work.Started := True;
end Two_Tasks;
