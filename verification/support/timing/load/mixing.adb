--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

package body Mixing is

   Sink : Unsigned_32 := 1 with Volatile;

   procedure Mix (Rounds : Positive) is
      Value : Unsigned_32 := Sink;
   begin
      for Round in 1 .. Rounds loop
         Value := Value xor Shift_Left (Value, 13);
         Value := Value xor Shift_Right (Value, 17);
      end loop;
      Sink := Value;
   end Mix;

end Mixing;
