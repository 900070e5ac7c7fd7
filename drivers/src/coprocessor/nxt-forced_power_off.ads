--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  When the power button was held long enough to switch the brick off: for 3 s, as in GNAT for
--  MINDSTORMS. The reading of each intact frame from the co-processor is observed, so that nothing
--  counts while the link is down.

with NXT.Configuration;

package NXT.Forced_Power_Off with Pure is

   type Button_Watch is private;
   --  At first the button does not count until it was released: it may still be held from
   --  switching the brick on.

   Ready : constant Button_Watch;
   --  The button counts at once.

   procedure Observe (This : in out Button_Watch; Pressed : Button_Id; Due : out Boolean);
   --  Pressed is the reading of the next frame. Due is True in the frame in which the hold gets
   --  long enough. A release counts when it lasts for 20 ms: a contact may bounce.

private

   Frame_Period_Ms : constant := 2 * Configuration.Link_Period_Ms;

   Hold_Frames    : constant := 3_000 / Frame_Period_Ms;
   Release_Frames : constant := 20 / Frame_Period_Ms;

   type Button_Watch is record
      Frames_Left     : Natural := 0;
      Released_Frames : Natural := 0;
   end record;
   --  Frames_Left: of the hold, until the brick is switched off; 0 while the button does not count.

   Ready : constant Button_Watch := (Frames_Left => Hold_Frames, others => <>);

end NXT.Forced_Power_Off;
