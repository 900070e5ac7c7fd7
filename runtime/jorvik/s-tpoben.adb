--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body System.Tasking.Protected_Objects.Entries is

   procedure Initialize_Protection_Entries
     (Object            : Protection_Entries_Access;
      Ceiling_Priority  : Integer;
      Compiler_Info     : System.Address;
      Entry_Queue_Maxes : Protected_Entry_Queue_Max_Access;
      Entry_Bodies      : Protected_Entry_Body_Access;
      Find_Body_Index   : Find_Body_Index_Access) is
   begin
      Initialize_Protection (Object.Common'Access, Ceiling_Priority);
      Object.Info := Compiler_Info;
      Object.Bodies := Entry_Bodies;
      Object.Body_Index := Find_Body_Index;
      Object.Maxima := Entry_Queue_Maxes;
      Object.In_Service := null;
      for Queue of Object.Queues loop
         Queue.Length := 0;
      end loop;
   end Initialize_Protection_Entries;

   procedure Lock_Entries (Object : Protection_Entries_Access) is
   begin
      Lock (Object.Common'Access);
   end Lock_Entries;

   procedure Lock_Read_Only_Entries (Object : Protection_Entries_Access) is
   begin
      Lock (Object.Common'Access);
   end Lock_Read_Only_Entries;

   procedure Unlock_Entries (Object : Protection_Entries_Access) is
   begin
      Unlock (Object.Common'Access);
   end Unlock_Entries;

end System.Tasking.Protected_Objects.Entries;
