--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;           use Ada.Real_Time;
with NXT.Bluetooth_Line;
with NXT.Bluetooth_Messages;  use NXT.Bluetooth_Messages;
with NXT.Bytes;               use NXT.Bytes;

package body NXT.Bluetooth is

   Poll_Period     : constant Time_Span := Milliseconds (4);
   Reset_Time      : constant Time_Span := Milliseconds (100);
   Start_Limit     : constant Time_Span := Seconds (5);
   Answer_Limit    : constant Time_Span := Milliseconds (500);

   Yes : constant Byte := 1;
   No  : constant Byte := 0;

   Address_Length : constant := 7;
   Device_Length  : constant := 7 + 16 + 4;

   Is_Available  : Boolean := False;
   Own_Address   : BT_Address := (others => 0);
   Current_State : Connection_State := Idle;
   Is_Serving    : Boolean := False;
   Expected_Pin  : Pin_Code := (others => 0);
   Peer          : BT_Address := (others => 0);
   Handle        : Byte := 0;
   Last_Failed   : Boolean := False;

   Poll_Limit : constant := 200;
   Polls_Left : Natural range 0 .. Poll_Limit := 0;
   --  Calls of Poll until the module is asked to close a connection that does not go on.

   function Available return Boolean is (Is_Available);
   function Address return BT_Address is (Own_Address);
   function State return Connection_State is (Current_State);

   subtype Address_Bytes is Byte_Array (1 .. Address_Length);

   function To_Bytes (Item : BT_Address) return Address_Bytes is
   begin
      return Result : Address_Bytes do
         for Index in Item'Range loop
            pragma Annotate (Ravenbrick, Iterations, 7, "bytes of an address");
            Result (Index + 1) := Item (Index);
         end loop;
      end return;
   end To_Bytes;

   function To_Address (Item : Message) return BT_Address is
   begin
      return Result : BT_Address do
         for Index in Result'Range loop
            pragma Annotate (Ravenbrick, Iterations, 7, "bytes of an address");
            Result (Index) := Item.Arguments (Index + 1);
         end loop;
      end return;
   end To_Address;

   function To_Device (Item : Message) return Device is
   begin
      return Result : Device do
         Result.Addr := To_Address (Item);
         for Index in Result.Name'Range loop
            pragma Annotate (Ravenbrick, Iterations, 16, "letters of a name");
            Result.Name (Index) := Item.Arguments (Address_Length + 1 + Index);
         end loop;
         for Index in Result.Class'Range loop
            pragma Annotate (Ravenbrick, Iterations, 4, "bytes of a class");
            Result.Class (Index) := Item.Arguments (Address_Length + 17 + Index);
         end loop;
      end return;
   end To_Device;

   procedure Convert_To_Friendly_Name (Input : String; Name : out Friendly_Name) is
   begin
      Name := (others => 0);
      for Index in 0 .. Natural'Min (Input'Length, Name'Last) - 1 loop
         pragma Annotate (Ravenbrick, Iterations, 15, "letters of a name");
         Name (Index) := Character'Pos (Input (Input'First + Index));
      end loop;
   end Convert_To_Friendly_Name;

   function To_Pin (Text : String) return Pin_Code is
   begin
      return Result : Pin_Code := (others => 0) do
         for Index in 0 .. Text'Length - 1 loop
            pragma Annotate (Ravenbrick, Iterations, 16, "letters of a code");
            Result (Index) := Character'Pos (Text (Text'First + Index));
         end loop;
      end return;
   end To_Pin;

   --  What a connection needs, in the order of its life

   procedure Send_Pin is
      Arguments : Byte_Array (1 .. Address_Length + Expected_Pin'Length);
   begin
      Arguments (1 .. Address_Length) := To_Bytes (Peer);
      for Index in Expected_Pin'Range loop
         pragma Annotate (Ravenbrick, Iterations, 16, "letters of a code");
         Arguments (Address_Length + 1 + Index) := Expected_Pin (Index);
      end loop;
      Send (Pin, Arguments);
   end Send_Pin;

   procedure End_Connection is
   begin
      Bluetooth_Line.Request_Stream (False);
      Bluetooth_Line.Discard_Unsent;
      Restart;
      Current_State := (if Is_Serving then Listening else Idle);
   end End_Connection;

   procedure Handle_Message (Item : Message) is
   begin
      case Item.Code is
         when Pin_Requested =>
            Peer := To_Address (Item);
            Send_Pin;
         when Connection_Offered =>
            Peer := To_Address (Item);
            Send (Accept_Offer, (1 => (if Current_State = Listening then Yes else No)));
         when Connect_Result =>
            if Item.Arguments (1) = Yes then
               Handle := Item.Arguments (2);
               Send (Open_Stream, (1 => Handle));
               Current_State := Opening;
               Polls_Left := Poll_Limit;
            else
               Last_Failed := True;
               End_Connection;
            end if;
         when Close_Result =>
            End_Connection;
         when Reset_Indication =>
            Last_Failed := Current_State /= Idle;
            Is_Serving := False;
            End_Connection;
         when others =>
            null;
      end case;
   end Handle_Message;

   --  A message, if one is complete. Not to be called while the stream is open.
   procedure Handle_Messages is
      Item  : Message;
      Found : Boolean;
   begin
      Receive (Item, Found);
      if Found then
         Handle_Message (Item);
      end if;
   end Handle_Messages;

   procedure Leave_Stream (Closed_By_Module : Boolean) is
   begin
      Bluetooth_Line.Discard_Unsent;
      Restart;
      Current_State := Closing;
      Polls_Left := (if Closed_By_Module then Poll_Limit else 0);
   end Leave_Stream;

   --  The wish for the stream follows the last message: what is sent after it belongs to it.
   procedure Continue_Opening (Is_Stream : Boolean) is
   begin
      if Is_Stream then
         Current_State := Connected;
      elsif Polls_Left = 0 then
         Leave_Stream (Closed_By_Module => False);
      else
         Polls_Left := Polls_Left - 1;
         if Bluetooth_Line.All_Sent then
            Bluetooth_Line.Request_Stream (True);
         end if;
      end if;
   end Continue_Opening;

   --  The wish for messages waits until the last byte has left, which would be taken for one. The
   --  module tells of an end that was not ours; otherwise, and when it does not, it is asked.
   procedure Continue_Closing (Is_Stream : Boolean) is
   begin
      if Bluetooth_Line.All_Sent then
         Bluetooth_Line.Request_Stream (False);
      end if;
      if Is_Stream then
         return;
      elsif Polls_Left = 0 then
         Send (Close_Connection, (1 => Handle));
         Polls_Left := Poll_Limit;
      else
         Polls_Left := Polls_Left - 1;
      end if;
      Handle_Messages;
   end Continue_Closing;

   procedure Poll is
      Is_Stream : Boolean;
   begin
      Bluetooth_Line.Read_Mode (Is_Stream);
      case Current_State is
         when Opening =>
            Continue_Opening (Is_Stream);
         when Connected =>
            if not Is_Stream then
               Leave_Stream (Closed_By_Module => True);
            end if;
         when Closing =>
            Continue_Closing (Is_Stream);
         when Idle | Listening | Calling =>
            Handle_Messages;
      end case;
   end Poll;

   procedure Disconnect is
   begin
      if Current_State in Opening | Connected then
         Leave_Stream (Closed_By_Module => False);
      end if;
   end Disconnect;

   --  Questions and answers. Each look for one comes after a wait, and whether to go on is decided
   --  before it: between two waits there is one look at most, and what a message needs or is asked
   --  next.

   procedure Wait_For
     (Code : Byte; Limit : Time_Span; Item : out Message; Found : out Boolean)
   is
      Now      : Time := Clock;
      Deadline : constant Time := Now + Limit;
   begin
      Found := False;
      loop
         pragma Annotate (Ravenbrick, Iterations, 1_251, "Start_Limit each Poll_Period");
         Now := Now + Poll_Period;
         delay until Now;
         exit when Now > Deadline;
         Receive (Item, Found);
         exit when Found and then Item.Code = Code;
         if Found then
            Handle_Message (Item);
            Found := False;
         end if;
      end loop;
   end Wait_For;

   procedure Ask
     (Question  : Byte;
      Arguments : Byte_Array;
      Answer    : Byte;
      Item      : out Message;
      Found     : out Boolean) is
   begin
      Send (Question, Arguments);
      Wait_For (Answer, Answer_Limit, Item, Found);
   end Ask;

   procedure Initialize is
      Item : Message;
   begin
      Bluetooth_Line.Power_Off;
      Is_Serving := False;
      Current_State := Idle;
      Restart;
      delay until Clock + Reset_Time;
      Bluetooth_Line.Power_On;
      Wait_For (Reset_Indication, Start_Limit, Item, Is_Available);
      if Is_Available then
         Ask (Get_Address, No_Arguments, Address_Result, Item, Is_Available);
         Own_Address := To_Address (Item);
      end if;
   end Initialize;

   procedure Set_Friendly_Name (Name : Friendly_Name) is
      Arguments : Byte_Array (1 .. Name'Length);
      Item      : Message;
      Found     : Boolean;
   begin
      for Index in Name'Range loop
         pragma Annotate (Ravenbrick, Iterations, 16, "letters of a name");
         Arguments (Index + 1) := Name (Index);
      end loop;
      Ask (Set_Name, Arguments, Name_Set, Item, Found);
   end Set_Friendly_Name;

   procedure Set_Discoverable (On : Boolean) is
      Item  : Message;
      Found : Boolean;
   begin
      Ask
        (Bluetooth_Messages.Set_Discoverable,
         (1 => (if On then Yes else No)),
         Discoverable_Set,
         Item,
         Found);
   end Set_Discoverable;

   --  Devices as the module lists them, until it says that the list ends.
   procedure Collect
     (Element, Ending : Byte; Limit : Time_Span; Found : out Device_List; Length : out Natural)
   is
      Now      : Time := Clock;
      Deadline : constant Time := Now + Limit;
      Item     : Message;
      Received : Boolean;
   begin
      Length := 0;
      loop
         pragma Annotate (Ravenbrick, Iterations, 81_726, "the longest search each Poll_Period");
         Now := Now + Poll_Period;
         delay until Now;
         exit when Now > Deadline;
         Receive (Item, Received);
         exit when Received and then Item.Code = Ending;
         if Received and then Item.Code = Element and then Item.Count >= Device_Length
           and then Length < Found'Length
         then
            Found (Found'First + Length) := To_Device (Item);
            Length := Length + 1;
         end if;
      end loop;
   end Collect;

   procedure Get_Known_Peers (Peers : out Device_List; Length : out Natural) is
   begin
      Send (Dump_List);
      Collect (List_Item, List_Stopped, Answer_Limit, Peers, Length);
   end Get_Known_Peers;

   procedure Find_Discoverable_Devices
     (Timeout_Sec : Natural; Discovered : out Device_List; Length : out Natural)
   is
      Unit_Ms   : constant := 1_280;
      Per_Second : constant := 1_000;
      Units     : constant Natural := Natural'Max (1, Timeout_Sec * Per_Second / Unit_Ms);
      Most      : constant Byte := Byte (Natural'Min (Discovered'Length, 255));
   begin
      Send (Begin_Inquiry, (Most, 0, Byte (Units), 0, 0, 0, 0));
      Collect
        (Inquiry_Result,
         Inquiry_Stopped,
         Milliseconds (Unit_Ms * Units) + Answer_Limit,
         Discovered,
         Length);
   end Find_Discoverable_Devices;

   procedure Add_Known_Device (Dev : Device; Success : out Boolean) is
      Arguments : Byte_Array (1 .. Device_Length);
      Item      : Message;
   begin
      Arguments (1 .. Address_Length) := To_Bytes (Dev.Addr);
      for Index in Dev.Name'Range loop
         pragma Annotate (Ravenbrick, Iterations, 16, "letters of a name");
         Arguments (Address_Length + 1 + Index) := Dev.Name (Index);
      end loop;
      for Index in Dev.Class'Range loop
         pragma Annotate (Ravenbrick, Iterations, 4, "bytes of a class");
         Arguments (Address_Length + 17 + Index) := Dev.Class (Index);
      end loop;
      Ask (Add_Device, Arguments, List_Result, Item, Success);
      Success := Success and then Item.Arguments (1) = Listed;
   end Add_Known_Device;

   --  Poll until the state is one of the two, or the attempt failed.
   procedure Wait_Until (Wanted : Connection_State; Success : out Boolean) is
      Next : Time := Clock;
   begin
      Last_Failed := False;
      loop
         pragma Annotate (Ravenbrick, Iterations, 150_000, "ten minutes; no job with a deadline");
         Next := Next + Poll_Period;
         delay until Next;
         Success := Current_State = Wanted;
         exit when Success or else Last_Failed;
         Poll;
      end loop;
   end Wait_Until;

   procedure Serve (Pin : Pin_Code) is
   begin
      Expected_Pin := Pin;
      Is_Serving := True;
      Current_State := Listening;
      Send (Open_Port);
   end Serve;

   procedure Accept_Connection
     (Pin : Pin_Code; Addr : out BT_Address; Success : out Boolean) is
   begin
      if Current_State = Idle then
         Serve (Pin);
      end if;
      Wait_Until (Connected, Success);
      Addr := Peer;
   end Accept_Connection;

   procedure Connect (Target : BT_Address; Success : out Boolean) is
   begin
      Connect (Target, To_Pin ("1234"), Success);
   end Connect;

   procedure Connect (Target : BT_Address; Pin : Pin_Code; Success : out Boolean) is
   begin
      Expected_Pin := Pin;
      Peer := Target;
      Current_State := Calling;
      Send (Bluetooth_Messages.Connect, To_Bytes (Target));
      Wait_Until (Connected, Success);
   end Connect;

   --  The stream

   function Room return Natural is
     (if Current_State = Connected then Bluetooth_Line.Room else 0);

   procedure Send (Data : Byte_Array) is
   begin
      Bluetooth_Line.Send (Data);
   end Send;

   procedure Receive (Data : out Byte_Array; Last : out Natural) is
   begin
      if Current_State = Connected then
         Bluetooth_Line.Receive (Data, Last);
      else
         Last := Data'First - 1;
      end if;
   end Receive;

   package body IO is separate;

end NXT.Bluetooth;
