--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Five tasks on two entries of one object, relative delays, and a date

package Many_Entries is

   protected Gate with Priority => 20 is
      procedure Open (Count : Natural);
      --  Let Count callers of Pass through

      entry Pass (Mark : Character);
      entry Left_Over;
      --  Open when nobody waits on Pass and the gate is open

      function Waiting return Natural;
   private
      Passes  : Natural := 0;
      No_More : Boolean := False;
   end Gate;

   task First with Priority => 10, Storage_Size => 512;
   task Second with Priority => 9, Storage_Size => 512;
   task Third with Priority => 11, Storage_Size => 512;
   task Last with Priority => 12, Storage_Size => 512;

end Many_Entries;
