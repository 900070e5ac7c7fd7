--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Four tasks on two entries of one object, in which order they are served is a matter of the
--  policy; a meeting, whose entries are opened by the calls of each other; a family of entries

package Callers is

   protected Gate with Priority => 20 is
      procedure Open;
      entry Main_Road (Mark : Character);
      entry Side_Road (Mark : Character);
   private
      Is_Open : Boolean := False;
   end Gate;

   protected Meeting with Priority => 20 is
      entry Start;
      --  Waits for a caller of Pass

      entry Pass;
   private
      Has_Started : Boolean := False;
   end Meeting;

   subtype Track is Positive range 1 .. 2;

   protected Platform with Priority => 20 is
      procedure Depart;
      entry Board (Track);
      function Waiting (On : Track) return Natural;
   private
      Departing : Boolean := False;
   end Platform;

   task Lowest with Priority => 9, Storage_Size => 512;
   task Low with Priority => 10, Storage_Size => 512;
   task Middle with Priority => 11, Storage_Size => 512;
   task High with Priority => 12, Storage_Size => 512;

end Callers;
