--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors as objects: a power and a direction that are set apart from each other.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

with NXT.Motor_Controls;  use NXT.Motor_Controls;

package NXT.Motors is

   type Abstract_Motor is abstract tagged private;

   function Id (This : Abstract_Motor) return Motor_Id;

   procedure Set_Power (This : in out Abstract_Motor; Power : Power_Percentage);
   --  Takes effect at once if the motor is moving, otherwise when it is made to move.

   function Current_Power (This : Abstract_Motor) return Power_Percentage;

   procedure Forward (This : in out Abstract_Motor);

   procedure Backward (This : in out Abstract_Motor);

   procedure Reverse_Direction (This : in out Abstract_Motor);
   --  No effect on a motor that was stopped.

   function Moving (This : Abstract_Motor) return Boolean;
   --  Whether the motor was told to move and not to stop since.

   procedure Stop (This : in out Abstract_Motor; Apply_Brake : Boolean := False);

private

   type Abstract_Motor is abstract tagged record
      Port  : Motor_Id;
      Mode  : Motion_Modes := Coast;
      Power : Power_Percentage := Power_Percentage'Last;
   end record;

end NXT.Motors;
