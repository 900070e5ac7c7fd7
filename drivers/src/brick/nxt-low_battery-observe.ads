--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR_IO;

procedure NXT.Low_Battery.Observe (Low_Inputs : in out Input_Count; Values : AVR_IO.Inputs)
  with Elaborate_Body;
--  To be called for each input with a low battery, which Low_Inputs counts from the first one in
--  each second; it is zero before the first. The loudspeaker hums in the last 0.2 s of each second.
--  The program ends when the battery has been empty for a second.
