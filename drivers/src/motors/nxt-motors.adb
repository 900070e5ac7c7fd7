--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Motors is

   function Id (This : Abstract_Motor) return Motor_Id is (This.Port);

   function Current_Power (This : Abstract_Motor) return Power_Percentage is (This.Power);

   function Moving (This : Abstract_Motor) return Boolean is (This.Mode in Forward .. Backward);

   procedure Enter (This : in out Abstract_Motor'Class; Mode : Motion_Modes) is
   begin
      This.Mode := Mode;
      Control_Motor (This.Port, This.Power, Mode);
   end Enter;

   procedure Set_Power (This : in out Abstract_Motor; Power : Power_Percentage) is
   begin
      This.Power := Power;
      if This.Mode in Forward .. Backward then
         Control_Motor (This.Port, Power, This.Mode);
      end if;
   end Set_Power;

   procedure Forward (This : in out Abstract_Motor) is
   begin
      Enter (This, Forward);
   end Forward;

   procedure Backward (This : in out Abstract_Motor) is
   begin
      Enter (This, Backward);
   end Backward;

   procedure Reverse_Direction (This : in out Abstract_Motor) is
   begin
      case This.Mode is
         when Forward  => Enter (This, Backward);
         when Backward => Enter (This, Forward);
         when Brake | Coast => null;
      end case;
   end Reverse_Direction;

   procedure Stop (This : in out Abstract_Motor; Apply_Brake : Boolean := False) is
   begin
      Enter (This, (if Apply_Brake then Brake else Coast));
   end Stop;

end NXT.Motors;
