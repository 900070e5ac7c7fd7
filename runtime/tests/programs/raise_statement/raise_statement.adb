--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

procedure Raise_Statement is
begin
   raise Program_Error with "words of the programmer";
end Raise_Statement;
