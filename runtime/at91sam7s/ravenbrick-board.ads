--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Clock tree and memory controller

package Ravenbrick.Board is
   pragma Preelaborate;

   procedure Start
     with Export, Convention => C, External_Name => "ravenbrick_start_board";
   --  Stop the watchdog, bring the master clock to 48.05 MHz unless the PLL runs already, and
   --  show the internal RAM at address 0. Called before any data of the program is initialised.

end Ravenbrick.Board;
