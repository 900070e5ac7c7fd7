--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => System.Multiprocessors.Dispatching_Domains

with System.Multiprocessors.Dispatching_Domains;

procedure Dispatching_Domains is
begin
   null;
end Dispatching_Domains;
