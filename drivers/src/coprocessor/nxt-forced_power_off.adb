--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Forced_Power_Off is

   procedure Observe (This : in out Button_Watch; Pressed : Button_Id; Due : out Boolean) is
   begin
      Due := False;
      if Pressed /= Power_Button then
         if This.Released_Frames < Release_Frames then
            This.Released_Frames := This.Released_Frames + 1;
         else
            This.Frames_Left := Hold_Frames;
         end if;
      else
         This.Released_Frames := 0;
         if This.Frames_Left > 0 then
            This.Frames_Left := This.Frames_Left - 1;
            Due := This.Frames_Left = 0;
         end if;
      end if;
   end Observe;

end NXT.Forced_Power_Off;
