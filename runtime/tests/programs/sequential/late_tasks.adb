--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;

package body Late_Tasks is

   procedure Note_Main is
   begin
      Note ('n');
   end Note_Main;

   task body One is
   begin
      Note ('1');
      delay until Time_Last;
   end One;

   task body Two is
   begin
      Note ('2');
      delay until Time_Last;
   end Two;

begin
   Note ('e');
end Late_Tasks;
