--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The text that the co-processor of the NXT wants to read within 298 s of power-on: without it,
--  it switches the brick off

package Handshake is

   procedure Send;
   --  Write it over the two-wire bus, polling

end Handshake;
