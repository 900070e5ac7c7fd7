--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dynamic_Attachment

with Ada.Interrupts.Names;

procedure Dynamic_Attachment is
begin
   Ada.Interrupts.Detach_Handler (Ada.Interrupts.Names.TWI);
end Dynamic_Attachment;
