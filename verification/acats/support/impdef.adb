--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The suite's implementation-defined operations for a target without files and time slices

package body ImpDef is

   procedure Exceed_Time_Slice is null;

   function Equivalent_File_Names (Left, Right : String) return Boolean is (Left = Right);

end ImpDef;
