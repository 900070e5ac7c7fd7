--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Commands of LEGO's communication protocol (LEGO MINDSTORMS NXT Bluetooth Developer Kit, appendix
--  2) that do not need LEGO's firmware: what brick is it, battery, sensors, motors, tones. A host
--  program such as nxt-python then works with a brick that runs an Ada program. Everything else is
--  answered as an unknown command. Regulation modes are accepted, and power is a duty cycle in all
--  of them. For one task at a time.

with NXT.Bytes;  use NXT.Bytes;

package NXT.Direct_Commands is

   Longest_Telegram : constant := 64;
   subtype Telegram is Byte_Array (1 .. Longest_Telegram);

   procedure Set_Identity (Name : String; Address : Eight_Bytes) with
     Pre => Name'Length <= 15;
   --  What a host is told. Address: of Bluetooth, seven bytes and a zero.

   procedure Execute (Item : Byte_Array; Reply : out Telegram; Last : out Natural);
   --  Carry a telegram out; the answer is in Reply (1 .. Last), and Last is 0 when none is wanted.

   procedure Tick;
   --  To be called every few milliseconds: stops motors that have reached their limits.

end NXT.Direct_Commands;
