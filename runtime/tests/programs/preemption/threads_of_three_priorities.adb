--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Journal; use Journal;

package body Threads_Of_Three_Priorities is

   Low_May_Run, Middle_May_Run, High_May_Run : Suspension_Object;

   procedure Start is
   begin
      Note ('s');
      Set_True (Low_May_Run);
      Note ('e');
   end Start;

   task body Low is
   begin
      loop
         Suspend_Until_True (Low_May_Run);
         Note ('l');
         Set_True (Middle_May_Run);
         Note ('L');
      end loop;
   end Low;

   task body Middle is
   begin
      loop
         Suspend_Until_True (Middle_May_Run);
         Note ('m');
         Set_True (High_May_Run);
         Note ('M');
      end loop;
   end Middle;

   task body High is
   begin
      loop
         Suspend_Until_True (High_May_Run);
         Note ('h');
         Set_True (Low_May_Run);
         Note ('H');
         if Length > 60 then
            Set_False (Low_May_Run);
         end if;
      end loop;
   end High;

end Threads_Of_Three_Priorities;
