--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Journal;

package body Callers is

   protected body Gate is

      procedure Open is
      begin
         Is_Open := True;
      end Open;

      entry Main_Road (Mark : Character) when Is_Open is
      begin
         Journal.Note (Mark);
      end Main_Road;

      entry Side_Road (Mark : Character) when Is_Open is
      begin
         Journal.Note (Mark);
      end Side_Road;

   end Gate;

   protected body Meeting is

      entry Start when Pass'Count > 0 is
      begin
         Has_Started := True;
      end Start;

      entry Pass when Has_Started is
      begin
         Has_Started := False;
      end Pass;

   end Meeting;

   protected body Platform is

      procedure Depart is
      begin
         Departing := True;
      end Depart;

      entry Board (for On in Track) when Departing is
      begin
         Journal.Note (if On = 1 then '1' else '2');
      end Board;

      function Waiting (On : Track) return Natural is (Board (On)'Count);

   end Platform;

   task body Low is
   begin
      delay 0.001;
      Gate.Side_Road ('l');
   end Low;

   task body Middle is
   begin
      delay 0.002;
      Gate.Main_Road ('m');
      Platform.Board (1);
   end Middle;

   task body High is
   begin
      delay 0.003;
      Gate.Side_Road ('h');
      Meeting.Start;
      Journal.Note ('s');
      Platform.Board (2);
   end High;

   task body Lowest is
   begin
      delay 0.004;
      Gate.Main_Road ('w');
   end Lowest;

end Callers;
