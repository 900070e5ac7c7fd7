--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Relative_Delay

procedure Relative_Delay is
begin
   delay 1.0;
end Relative_Delay;
