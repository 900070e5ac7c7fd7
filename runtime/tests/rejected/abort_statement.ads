--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Abort_Statement is

   task Victim with Storage_Size => 512;

   procedure Kill;

end Abort_Statement;
