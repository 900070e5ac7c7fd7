--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The size of the heap is not stated: the program does not link

procedure Heap is
   type Integer_Access is access Integer;
   Item : Integer_Access := new Integer'(1) with Volatile;
begin
   Item.all := 2;
end Heap;
