--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Speeds of the motors from differences of encoder counts over the time between the readings.
--
--  One count is one degree. Over a single period of 4 ms a difference can only be a multiple of
--  250 degrees per second, which is 2.2 V in the loop: the plain difference of the last two
--  readings would show a wheel at 4 V as 250 or 500 degrees per second. Over a window of eight
--  periods the step is 31 degrees per second at the price of 16 ms mean delay, which the design
--  takes into account.

with Controller_Design;
with NXT;
with NXT.Motor_Encoders;
with Quantities;

package Speedometer is

   Window : constant := Controller_Design.Speed_Window;
   --  Periods between the two readings of a difference.

   type Motor_Speeds is array (NXT.Motor_Id) of Quantities.Degrees_Per_Second;

   type Meter is limited private;

   procedure Start (This : out Meter; Now : NXT.Motor_Encoders.Reading);
   --  Forget earlier readings; until Window readings have come, Now stands for them.

   procedure Measure
     (This : in out Meter; Now : NXT.Motor_Encoders.Reading; Speeds : out Motor_Speeds);
   --  To be called once per period, with a later reading than before.

private

   type Reading_Index is mod Window;
   type Readings is array (Reading_Index) of NXT.Motor_Encoders.Reading;

   type Meter is limited record
      Past   : Readings;
      Oldest : Reading_Index;
   end record;

end Speedometer;
