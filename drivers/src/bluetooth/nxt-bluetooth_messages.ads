--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Messages between chip and Bluetooth module: length of what follows, code, arguments, and the
--  negative sum of code and arguments, high byte first. In what the module sends the length
--  belongs to the sum as well.

with NXT.Bytes;  use NXT.Bytes;

package NXT.Bluetooth_Messages is

   Longest_Arguments : constant := 40;

   subtype Argument_Count is Natural range 0 .. Longest_Arguments;

   type Message is record
      Code      : Byte := 0;
      Count     : Argument_Count := 0;
      Arguments : Byte_Array (1 .. Longest_Arguments) := (others => 0);
   end record;

   No_Arguments : constant Byte_Array (1 .. 0) := (others => 0);

   procedure Send (Code : Byte; Arguments : Byte_Array := No_Arguments) with
     Pre => Arguments'Length <= Longest_Arguments;

   Check_Length    : constant := 2;
   Overhead        : constant := 1 + Check_Length;
   Longest_Message : constant := 1 + Overhead + Longest_Arguments;
   --  Overhead: code and sum, what the length counts besides the arguments.

   procedure Receive (Item : out Message; Found : out Boolean);
   --  The next message that has come whole and right, if any. Longer ones are passed over. A call
   --  takes 16 bytes at most, so that it is short: a long message needs more than one.

   procedure Restart;
   --  Forget the beginning of a message.

   --  Codes to the module
   Begin_Inquiry    : constant Byte := 16#00#;
   Connect          : constant Byte := 16#02#;
   Open_Port        : constant Byte := 16#03#;
   Add_Device       : constant Byte := 16#05#;
   Dump_List        : constant Byte := 16#07#;
   Close_Connection : constant Byte := 16#08#;
   Accept_Offer     : constant Byte := 16#09#;
   Pin              : constant Byte := 16#0A#;
   Open_Stream      : constant Byte := 16#0B#;
   Set_Discoverable : constant Byte := 16#1C#;
   Set_Name         : constant Byte := 16#21#;
   Get_Address      : constant Byte := 16#27#;

   --  Codes from the module
   Inquiry_Result     : constant Byte := 16#0F#;
   Inquiry_Stopped    : constant Byte := 16#10#;
   Connect_Result     : constant Byte := 16#13#;
   Reset_Indication   : constant Byte := 16#14#;
   Pin_Requested      : constant Byte := 16#15#;
   Connection_Offered : constant Byte := 16#16#;
   List_Result        : constant Byte := 16#17#;
   List_Item          : constant Byte := 16#18#;
   List_Stopped       : constant Byte := 16#19#;
   Close_Result       : constant Byte := 16#1A#;
   Discoverable_Set   : constant Byte := 16#20#;
   Name_Set           : constant Byte := 16#22#;
   Address_Result     : constant Byte := 16#28#;

   Listed : constant Byte := 16#50#;
   --  Argument of List_Result: success.

end NXT.Bluetooth_Messages;
