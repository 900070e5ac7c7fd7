--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;

package body NXT.Buttons is

   function Current_Button return Button_Id is (NXT.AVR.Button);

end NXT.Buttons;
