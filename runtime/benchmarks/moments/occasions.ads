--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Timing events in the situation in which moving and cancelling take longest: three others are
--  earlier, and the clock's count has just begun again

package Occasions is

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   procedure Play;

end Occasions;
