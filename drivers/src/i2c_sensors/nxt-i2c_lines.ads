--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One soft two-wire bus as a state machine that a timer advances by half bits: between two ticks
--  either the clock or the data changes. No timer and no interrupt here.

with Interfaces;

private package NXT.I2C_Lines is

   subtype Byte is Interfaces.Unsigned_8;
   type Byte_Array is array (Positive range <>) of Byte;

   Longest_Header : constant := 5;
   --  Device and register.
   Longest_Data   : constant := 32;
   subtype Data_Length is Natural range 0 .. Longest_Data;

   type Bus_State is (Idle, Condition_Setup, Condition_Clock, Condition, Bit_Setup, Bit_Clock,
                      Bit_Sample);

   type Bus_Condition is (Start, Stop);

   type Bus is record
      State        : Bus_State := Idle;
      Pending      : Bus_Condition := Start;
      LEGO_Mode    : Boolean := False;
      Failed       : Boolean := False;
      Output       : Byte_Array (1 .. Longest_Header + Longest_Data) := (others => 0);
      Output_Last  : Natural := 0;
      Output_Next  : Positive := 1;
      Input        : Byte_Array (1 .. Longest_Data) := (others => 0);
      Input_Length : Data_Length := 0;
      Input_Count  : Data_Length := 0;
      Read_Address : Byte := 0;
      Receiving    : Boolean := False;
      Shift        : Byte := 0;
      Bits         : Natural range 0 .. 9 := 0;
      Waits        : Natural := 0;
   end record;
   --  Output_Next beyond Output_Last: only the address of a read remains to be sent. Bits: clocked
   --  of this byte, the acknowledge included.

   procedure Take_Lines (Port : Sensor_Id);
   --  Both lines are let go, to be driven low from now on only.

   function Free (Port : Sensor_Id) return Boolean;
   --  Whether both lines are high.

   procedure Begin_Transfer (This : in out Bus);
   --  Output, Input_Length and Read_Address are set; the lines are free.

   procedure Tick (This : in out Bus; Port : Sensor_Id)
     with Pre => This.State /= Idle;
   --  Half a bit has passed. When This.State becomes Idle the transfer has ended.

end NXT.I2C_Lines;
