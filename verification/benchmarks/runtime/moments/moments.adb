--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Occasions;

procedure Moments with Priority => 1 is
begin
   Occasions.Play;
end Moments;
