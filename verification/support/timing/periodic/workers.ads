--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Eight periodic tasks, released together for the first time, whose periods and loads stand in
--  tables that are written into the image before it is run.

with System;

package Workers is

   subtype Slot is Positive range 1 .. 8;

   task type Worker (Number : Slot; Urgency : System.Priority) with
     Priority     => Urgency,
     Storage_Size => 768;

   Worker_1 : Worker (1, 11);
   Worker_2 : Worker (2, 12);
   Worker_3 : Worker (3, 13);
   Worker_4 : Worker (4, 14);
   Worker_5 : Worker (5, 15);
   Worker_6 : Worker (6, 16);
   Worker_7 : Worker (7, 17);
   Worker_8 : Worker (8, 18);

end Workers;
