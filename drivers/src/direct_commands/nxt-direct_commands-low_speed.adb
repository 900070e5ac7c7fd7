--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;        use Interfaces;
with NXT.I2C_Ports;     use NXT.I2C_Ports;
with NXT.Sensor_Ports;
with System;

package body NXT.Direct_Commands.Low_Speed is

   Success       : constant Byte := 16#00#;
   Pending       : constant Byte := 16#20#;
   Out_Of_Range  : constant Byte := 16#C0#;
   Bus_Error     : constant Byte := 16#DD#;

   Longest_Register : constant := 4;

   Awaited : array (Sensor_Id) of Byte := (others => 0);

   procedure Open (Port : Sensor_Id; Supply : Sensor_Power) is
   begin
      Configure_I2C_Port (Port, LEGO_Mode);
      NXT.Sensor_Ports.Set_Input_Power (Port, Supply);
      Awaited (Port) := 0;
   end Open;

   procedure Close (Port : Sensor_Id) is
   begin
      if Enabled (Port) then
         Disable (Port);
      end if;
   end Close;

   function Status_Of (Result : Integer) return Byte is
     (if Result >= 0 then Success
      elsif Result = Port_Busy then Pending
      elsif Result = Too_Long then Out_Of_Range
      else Bus_Error);

   --  The register of a read: what follows the device, at most four bytes.
   procedure Start_Read
     (Port : Sensor_Id; Data : Byte_Array; Wanted : Positive; Result : out Integer)
   is
      Register : Unsigned_32 := 0;
   begin
      for Item of Data (Data'First + 1 .. Data'Last) loop
         Register := 256 * Register + Unsigned_32 (Item);
      end loop;
      Start_Transaction
        (Port, Unsigned_32 (Data (Data'First)), Register, Unsigned_16 (Data'Length - 1),
         System.Null_Address, Wanted, Read, Result);
   end Start_Read;

   procedure Start_Write (Port : Sensor_Id; Data : Byte_Array; Result : out Integer) is
   begin
      Start_Transaction
        (Port, Unsigned_32 (Data (Data'First)), 0, 0, Data (Data'First + 1)'Address,
         Data'Length - 1, Write, Result);
   end Start_Write;

   procedure Write (Port : Sensor_Id; Data : Byte_Array; Wanted : Byte; Status : out Byte) is
      Result : Integer := Too_Long;
   begin
      if Wanted in 1 .. Longest and then Data'Length in 1 .. Longest_Register + 1 then
         Start_Read (Port, Data, Positive (Wanted), Result);
      elsif Wanted = 0 and then Data'Length in 2 .. Longest then
         Start_Write (Port, Data, Result);
      end if;
      Status := Status_Of (Result);
      if Status = Success then
         Awaited (Port) := Wanted;
      end if;
   end Write;

   procedure Read
     (Port : Sensor_Id; Data : out Data_Bytes; Count : out Byte; Status : out Byte)
   is
      Result : Integer;
   begin
      Data := (others => 0);
      Count := 0;
      Complete_Transaction (Port, Data'Address, Positive'Max (1, Natural (Awaited (Port))), Result);
      Status := Status_Of (Result);
      if Status = Success then
         Count := Awaited (Port);
      end if;
   end Read;

   procedure Get_Status (Port : Sensor_Id; Ready : out Byte; Status : out Byte) is
      Ignored : Data_Bytes;
   begin
      Read (Port, Ignored, Ready, Status);
   end Get_Status;

end NXT.Direct_Commands.Low_Speed;
