--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the vehicle shows of itself: one consistent set of values for the display, and single
--  symbols for an observer of the memory.

with Driving;

package Panel with Elaborate_Body is

   procedure Publish (Now : Driving.Status);

   procedure Draw;
   --  Show the last Status published.

end Panel;
