--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A timing event that sets itself again at random phases while the environment task computes

with Series; use Series;

package Expiring is

   Samples : constant := 10_000;

   Results : Summary
     with Export, Convention => C, External_Name => "results";
   --  From the event's time until the handler's first statement, to the tick of the clock

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   procedure Be_Busy with No_Return;

end Expiring;
