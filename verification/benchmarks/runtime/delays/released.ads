--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Releases by delay until, first of an idle processor, at any time and at ticks of the clock, then
--  of a busy one; the observer of the threads takes the times

package Released is

   Samples       : constant := 10_200;
   Pause_Seconds : constant := 5;
   --  Idle, between two phases

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   procedure Be_Busy;
   --  From the second phase on

   task Delayed with Priority => 10, Storage_Size => 1024;

end Released;
