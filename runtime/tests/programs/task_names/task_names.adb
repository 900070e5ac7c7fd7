--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Task_Identification; use Ada.Task_Identification;

with Named;

procedure Task_Names with Priority => 1 is
begin
   Named.Note (1, Image (Named.With_Name'Identity));
   Named.Note (2, Image (Named.Without_Name'Identity));
   Named.Note (3, Image (Environment_Task));
   Named.Note (4, Image (Null_Task_Id));
end Task_Names;
