--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the chapter on the run-time follows: Low calls a protected procedure and releases High;
--  High suspends itself again, and Low goes on; then an interrupt's handler releases Server

package Path_Tasks is

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   task Low with Priority => 10, Storage_Size => 768;
   task High with Priority => 12, Storage_Size => 768;
   task Server with Priority => 14, Storage_Size => 768;

end Path_Tasks;
