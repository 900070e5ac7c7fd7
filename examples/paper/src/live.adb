--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Live is

   procedure Adopt (Battery : Float) is
   begin
      Functional_P := (Battery => Battery, Ki => Current (Ki), Kp => Current (Kp));
   end Adopt;

begin
   Declare_Signal (1, "set_left", "V", Real);
   Declare_Signal (1, "set_right", "V", Real);
   Declare_Signal (1, "real_left", "V", Real);
   Declare_Signal (1, "real_right", "V", Real);
   Declare_Signal (1, "out_left", "V", Real);
   Declare_Signal (1, "out_right", "V", Real);
   Declare_Signal (1, "joystick", "deg", Whole);
   Declare_Signal (1, "battery", "mV", Whole);
end Live;
