--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sensor ports as two-wire (I2C) buses of 9,600 bit/s, made in software: Digital_0 is the clock,
--  Digital_1 the data. An interrupt of timer channel 1 makes each half bit while a transaction
--  runs, at most on all four ports at a time; nobody polls. Lines are driven low or let go, so a
--  sensor may stretch the clock.

with Interfaces;  use Interfaces;
with System;

package NXT.I2C_Ports with Elaborate_Body is

   Maximum_Length : constant := 32;
   --  Bytes of data in one transaction.

   procedure Initialize;
   --  All ports disabled. Done at elaboration.

   subtype IO_Modes is Unsigned_16;

   Standard_Mode : constant IO_Modes := 0;
   LEGO_Mode     : constant IO_Modes := 1;
   Always_Active : constant IO_Modes := 2;
   No_Release    : constant IO_Modes := 4;
   --  LEGO_Mode is what LEGO's own sensors need: a stop and an extra clock pulse between the number
   --  of a register and the reading of it, more time before each byte, no stop after the last one.
   --  Always_Active and No_Release, which concern lines that are driven high, change nothing here.

   procedure Configure_I2C_Port (Port : Sensor_Id; Mode : IO_Modes);
   --  Take the port's lines and enable it. Does not switch its supply.

   function Enabled (Port : Sensor_Id) return Boolean;

   procedure Disable (Port : Sensor_Id);
   --  Lose the transaction that runs and reset the port.

   procedure Disable_All_Ports;

   function Busy (Port : Sensor_Id) return Boolean;
   --  Whether a transaction runs.

   type Transfer_Type is (Read, Write);

   --  Results

   Not_Enabled : constant Integer := -1;
   Port_Busy   : constant Integer := -2;
   Port_Fault  : constant Integer := -3;
   --  Nobody acknowledged, or a line stays low.
   Too_Long    : constant Integer := -4;

   procedure Start_Transaction
     (Port                   : Sensor_Id;
      Device_Address         : Unsigned_32;
      Register_Address       : Unsigned_32;
      Register_Address_Bytes : Unsigned_16;
      Write_Buffer           : System.Address;
      Bytes_To_Transfer      : Positive;
      Operation              : Transfer_Type;
      Result                 : out Integer);
   --  Start and return. Device_Address is the address byte of a write: twice the 7-bit address.
   --  Register_Address is sent in up to 4 bytes, the most significant one first. Write_Buffer is
   --  copied, and not used by a read. Result is 0 or one of the above.

   procedure Await_End (Port : Sensor_Id);
   --  Suspend the caller until the transaction has ended. To be called once after each successful
   --  Start_Transaction, by one task per port. Lasts 104 us per bit, 9 bits per byte, and at most
   --  6 ms more when a sensor holds the clock.

   procedure Complete_Transaction
     (Port            : Sensor_Id;
      Incoming_Buffer : System.Address;
      Bytes_To_Read   : Positive;
      Result          : out Integer);
   --  What became of the transaction: the number of bytes transferred, of which those read are in
   --  Incoming_Buffer, or a negative result. What is read when a sensor is unplugged meanwhile is
   --  16#FF#, and nothing on the bus tells it from data.

end NXT.I2C_Ports;
