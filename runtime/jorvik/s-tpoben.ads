--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Protected objects with any number of entries on whose queues any number of tasks wait, as the
--  Jorvik profile has them. Ravenbrick.Entry_Queues says in which order they are served.

with Ravenbrick.Entry_Queues;
with Ravenbrick.Threads;

package System.Tasking.Protected_Objects.Entries is
   pragma Elaborate_Body;

   subtype Positive_Protected_Entry_Index is
     Protected_Entry_Index range 1 .. Protected_Entry_Index'Last;

   type Find_Body_Index_Access is access
     function (O : System.Address; E : Protected_Entry_Index) return Protected_Entry_Index;
   --  Which body belongs to entry E: the members of a family share one

   type Protected_Entry_Body_Array is
     array (Positive_Protected_Entry_Index range <>) of Entry_Body;
   type Protected_Entry_Body_Access is access constant Protected_Entry_Body_Array;

   type Protected_Entry_Queue_Max_Array is
     array (Positive_Protected_Entry_Index range <>) of Natural;
   type Protected_Entry_Queue_Max_Access is access constant Protected_Entry_Queue_Max_Array;
   --  Max_Queue_Length of each entry; 0: none

   type Entry_Queue_Array is array (Positive_Protected_Entry_Index range <>)
     of Ravenbrick.Entry_Queues.Queue
     with Suppress_Initialization;

   type Protection_Entries (Num_Entries : Protected_Entry_Index) is limited record
      Common     : aliased Protection;
      Info       : System.Address;
      Bodies     : Protected_Entry_Body_Access;
      Body_Index : Find_Body_Index_Access;
      Maxima     : Protected_Entry_Queue_Max_Access;
      In_Service : Ravenbrick.Threads.Thread_Id;
      --  The thread whose call is being executed

      Queues     : Entry_Queue_Array (1 .. Num_Entries);
   end record;

   type Protection_Entries_Access is access all Protection_Entries;

   procedure Initialize_Protection_Entries
     (Object            : Protection_Entries_Access;
      Ceiling_Priority  : Integer;
      Compiler_Info     : System.Address;
      Entry_Queue_Maxes : Protected_Entry_Queue_Max_Access;
      Entry_Bodies      : Protected_Entry_Body_Access;
      Find_Body_Index   : Find_Body_Index_Access);
   --  Set ceiling and entries; Compiler_Info goes to barriers and bodies

   procedure Lock_Entries (Object : Protection_Entries_Access);
   pragma Inline_Always (Lock_Entries);
   --  As Lock

   procedure Lock_Read_Only_Entries (Object : Protection_Entries_Access);
   pragma Inline_Always (Lock_Read_Only_Entries);
   --  As Lock_Read_Only

   procedure Unlock_Entries (Object : Protection_Entries_Access);
   pragma Inline_Always (Unlock_Entries);
   --  As Unlock; the entries are not looked at

end System.Tasking.Protected_Objects.Entries;
