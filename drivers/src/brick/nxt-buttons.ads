--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The brick's four buttons.

package NXT.Buttons is

   function Current_Button return Button_Id;
   --  The button that is held down now, No_Button if none is.

end NXT.Buttons;
