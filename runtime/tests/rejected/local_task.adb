--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Task_Hierarchy

procedure Local_Task is
   task Inner with Storage_Size => 512;

   task body Inner is
   begin
      null;
   end Inner;
begin
   null;
end Local_Task;
