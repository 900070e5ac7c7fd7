--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Protected objects with one entry on whose queue at most one task waits. The task that opens
--  the barrier executes the entry body for the waiting one before it leaves the object.

package System.Tasking.Protected_Objects.Single_Entry is
   pragma Elaborate_Body;

   type Protection_Entry is limited private;

   type Protection_Entry_Access is access all Protection_Entry;

   type Entry_Body_Access is access constant Entry_Body;

   procedure Initialize_Protection_Entry
     (Object           : Protection_Entry_Access;
      Ceiling_Priority : Integer;
      Compiler_Info    : System.Address;
      Entry_Body       : Entry_Body_Access);
   --  Set ceiling and entry; Compiler_Info goes to barrier and body

   procedure Lock_Entry (Object : Protection_Entry_Access);
   pragma Inline_Always (Lock_Entry);
   --  As Lock

   procedure Lock_Read_Only_Entry (Object : Protection_Entry_Access);
   pragma Inline_Always (Lock_Read_Only_Entry);
   --  As Lock_Read_Only

   procedure Unlock_Entry (Object : Protection_Entry_Access);
   pragma Inline_Always (Unlock_Entry);
   --  As Unlock; the entry is not looked at

   procedure Service_Entry (Object : Protection_Entry_Access);
   --  Execute the entry for the waiting task if the barrier is open, then unlock

   procedure Protected_Single_Entry_Call
     (Object : Protection_Entry_Access; Uninterpreted_Data : System.Address);
   --  Call the entry with the parameters at Uninterpreted_Data. Program_Error when a task waits
   --  already or when the caller is in a protected action.

   function Protected_Count_Entry (Object : Protection_Entry) return Natural;
   --  Tasks waiting: 0 or 1

   function Protected_Single_Entry_Caller (Object : Protection_Entry) return Task_Id;
   --  The task whose call is being executed

private

   type Protection_Entry is limited record
      Common     : aliased Protection;
      Info       : System.Address;
      Code       : Entry_Body_Access;
      Waiting    : Ravenbrick.Threads.Thread_Id;
      In_Service : Ravenbrick.Threads.Thread_Id;
   end record;

end System.Tasking.Protected_Objects.Single_Entry;
