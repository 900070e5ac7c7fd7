--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Journal; use Journal;

package body Two_Waiters is

   Flag : Suspension_Object;

   task body First_Waiter is
   begin
      Note (if Current_State (Flag) then '1' else '0');
      Set_True (Flag);
      Set_True (Flag);
      Note (if Current_State (Flag) then '1' else '0');
      Suspend_Until_True (Flag);
      Note (if Current_State (Flag) then '1' else '0');
      Set_True (Flag);
      Set_False (Flag);
      Note (if Current_State (Flag) then '1' else '0');
      Suspend_Until_True (Flag);
      Note ('x');
   end First_Waiter;

   task body Second_Waiter is
   begin
      Note ('2');
      Suspend_Until_True (Flag);
      Note ('y');
   end Second_Waiter;

end Two_Waiters;
