--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Entry calls of protected objects with queues. Who makes a barrier true executes the bodies for
--  the waiting tasks before it leaves the object.

with System.Tasking.Protected_Objects.Entries;

package System.Tasking.Protected_Objects.Operations is
   pragma Elaborate_Body;

   type Communication_Block is limited private;
   --  Of a call; the profile's calls have nothing to remember

   procedure Protected_Entry_Call
     (Object             : Entries.Protection_Entries_Access;
      E                  : Protected_Entry_Index;
      Uninterpreted_Data : System.Address;
      Mode               : Call_Modes;
      Block              : out Communication_Block);
   --  Call entry E with the parameters at Uninterpreted_Data; Mode is Simple_Call. Program_Error
   --  when the caller is in a protected action or the entry's Max_Queue_Length is reached.

   procedure Service_Entries (Object : Entries.Protection_Entries_Access);
   --  Execute open entries for waiting tasks until there are none, then unlock

   procedure Complete_Entry_Body (Object : Entries.Protection_Entries_Access) is null;
   --  Called at the end of each entry body

   function Protected_Count
     (Object : Entries.Protection_Entries; E : Protected_Entry_Index) return Natural;
   --  Tasks that wait on entry E

   function Protected_Entry_Caller (Object : Entries.Protection_Entries) return Task_Id;
   --  The task whose call is being executed

private

   type Communication_Block is limited null record;

end System.Tasking.Protected_Objects.Operations;
