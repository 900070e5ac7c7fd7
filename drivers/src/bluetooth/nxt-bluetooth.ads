--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The Bluetooth module: other devices find this brick and connect to it, or are found and
--  connected to; then bytes flow both ways. For one task at a time.
--
--  Operations that say so wait by `delay until`, so that other tasks run. A task that must not
--  wait starts Serve once and calls Poll every few milliseconds.

with Interfaces;  use Interfaces;
with NXT.Bytes;

package NXT.Bluetooth is

   type BT_Address    is array (0 .. 6)  of Unsigned_8;
   type Friendly_Name is array (0 .. 15) of Unsigned_8;
   type Class_Service is array (0 .. 3)  of Unsigned_8;
   type Pin_Code      is array (0 .. 15) of Unsigned_8;
   --  Texts end with a zero when they are shorter.

   type Device is record
      Addr  : BT_Address;
      Name  : Friendly_Name;
      Class : Class_Service;
   end record;

   type Device_List is array (Natural range <>) of Device;

   --  Setting up. These wait for the module's answer, at most for half a second each, Initialize
   --  for five.

   procedure Initialize;
   --  To be called first, and again to begin anew: the module is reset.

   function Available return Boolean;
   --  Whether the module answered to Initialize.

   function Address return BT_Address;
   --  Of this brick, once it is available.

   procedure Convert_To_Friendly_Name (Input : String; Name : out Friendly_Name);
   --  Cut off after 15 letters.

   function To_Pin (Text : String) return Pin_Code with
     Pre => Text'Length in 1 .. 16;

   procedure Set_Friendly_Name (Name : Friendly_Name);
   procedure Set_Discoverable (On : Boolean);

   procedure Get_Known_Peers (Peers : out Device_List; Length : out Natural);
   --  Devices of the module's own list, at most Peers'Length.

   procedure Add_Known_Device (Dev : Device; Success : out Boolean);

   procedure Find_Discoverable_Devices
     (Timeout_Sec : Natural; Discovered : out Device_List; Length : out Natural)
   with Pre => Timeout_Sec <= 60;
   --  Waits so many seconds, or until the list is full.

   --  Connections. One at a time.

   type Connection_State is (Idle, Listening, Calling, Opening, Connected, Closing);
   --  Opening: a connection exists, its stream is on the way.

   function State return Connection_State;

   procedure Accept_Connection
     (Pin : Pin_Code; Addr : out BT_Address; Success : out Boolean)
   with Pre => Available;
   --  Waits until another device has connected; not Success when that failed.

   procedure Connect (Target : BT_Address; Pin : Pin_Code; Success : out Boolean) with
     Pre => Available and then State = Idle;
   --  Waits until the other device has accepted, or not. The code matters for a device that this
   --  brick was not connected with before.

   procedure Connect (Target : BT_Address; Success : out Boolean) with
     Pre => Available and then State = Idle;
   --  The same with the code 1234, LEGO's own.

   procedure Disconnect;
   --  Ask for the end of the connection; it comes with the next calls of Poll.

   --  Serving without waiting

   procedure Serve (Pin : Pin_Code) with
     Pre  => Available and then State = Idle,
     Post => State = Listening;
   --  From now on Poll accepts whoever knows the code, and after its end the next one.

   procedure Poll;
   --  Take the module's messages, and see whether the stream goes on. To be called often; while
   --  a connection exists, between any two calls of Receive that found nothing.

   --  The stream. Nothing here waits.

   function Room return Natural;
   --  Bytes that Send takes: none without a connection.

   procedure Send (Data : Bytes.Byte_Array) with
     Pre => Data'Length <= Room;

   procedure Receive (Data : out Bytes.Byte_Array; Last : out Natural) with
     Pre => Data'Length > 0;
   --  What has come, in Data (Data'First .. Last); nothing without a connection.

   --  Messages of a fixed size, each with its length before it

   generic
      type Message (<>) is limited private;
   package IO is

      procedure Send (This : access Message);
      --  Waits for room; without a connection the message is dropped.

      procedure Receive (This : access Message);
      --  Waits for a whole message of this size; others are passed over. Returns at once when
      --  there is no connection any more.

   end IO;

end NXT.Bluetooth;
