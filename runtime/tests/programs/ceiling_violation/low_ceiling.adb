--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;

package body Low_Ceiling is

   protected body Object is
      procedure Touch is
      begin
         Note ('t');
      end Touch;
   end Object;

   task body At_Ceiling is
   begin
      Object.Touch;
      delay until Time_Last;
   end At_Ceiling;

   task body Above_Ceiling is
   begin
      delay until Clock + Milliseconds (1);
      Note ('a');
      Object.Touch;
   end Above_Ceiling;

end Low_Ceiling;
