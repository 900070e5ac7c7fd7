--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.I2C_Ports;  use NXT.I2C_Ports;

package body NXT.I2C_Sensors is

   Version_Register     : constant := 16#00#;
   Product_Id_Register  : constant := 16#08#;
   Sensor_Type_Register : constant := 16#10#;

   procedure Set_Port_Id (This : in out I2C_Sensor; To : Sensor_Id) is
   begin
      This.Port_Id := To;
   end Set_Port_Id;

   function Port (This : I2C_Sensor) return Sensor_Id is (This.Port_Id);

   procedure Set_Device_Address (This : in out I2C_Sensor; To : Unsigned_32) is
   begin
      This.Device_Address := To;
   end Set_Device_Address;

   function Device (This : I2C_Sensor) return Unsigned_32 is (This.Device_Address);

   procedure Transact
     (This      : I2C_Sensor'Class;
      Register  : Unsigned_32;
      Buffer    : System.Address;
      Length    : Positive;
      Operation : Transfer_Type;
      Result    : out Integer)
   is
   begin
      Start_Transaction
        (This.Port_Id, This.Device_Address, Register, 1, Buffer, Length, Operation, Result);
      if Result >= 0 then
         Await_End (This.Port_Id);
         Complete_Transaction (This.Port_Id, Buffer, Length, Result);
         Result := Integer'Min (Result, 0);
      end if;
   end Transact;

   procedure Send_Data
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer)
   is
   begin
      Transact (This, Register, Buffer, Length, Write, Result);
   end Send_Data;

   procedure Get_Data
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer)
   is
   begin
      Transact (This, Register, Buffer, Length, Read, Result);
   end Get_Data;

   procedure Get_Version
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean)
   is
   begin
      Fetch_String (I2C_Sensor'Class (This), Version_Register, Result'Length, Result, Success);
   end Get_Version;

   procedure Get_Product_Id
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean)
   is
   begin
      Fetch_String (I2C_Sensor'Class (This), Product_Id_Register, Result'Length, Result, Success);
   end Get_Product_Id;

   procedure Get_Sensor_Type
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean)
   is
   begin
      Fetch_String (I2C_Sensor'Class (This), Sensor_Type_Register, Result'Length, Result, Success);
   end Get_Sensor_Type;

   procedure Fetch_String
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Length   : Positive;
      Fetched  : out Query_Reply;
      Success  : out Boolean)
   is
      Bytes : Multiple_Bytes (1 .. Length);
   begin
      Fetch_Multiple_Bytes (I2C_Sensor'Class (This), Register, Bytes, Success);
      Fetched := (others => ' ');
      if Success then
         for Place in Bytes'Range loop
            Fetched (Place) := Character'Val (Bytes (Place));
         end loop;
      end if;
   end Fetch_String;

   procedure Fetch_Multiple_Bytes
     (This          : in out I2C_Sensor;
      Base_Register : Unsigned_32;
      Output        : out Multiple_Bytes;
      Success       : out Boolean)
   is
      Result : Integer;
   begin
      Output := (others => 0);
      Get_Data
        (I2C_Sensor'Class (This), Base_Register, Output'Address, Output'Length, Result);
      Success := Result = 0;
   end Fetch_Multiple_Bytes;

   procedure Set_Multiple_Bytes
     (This          : in out I2C_Sensor;
      Base_Register : Unsigned_32;
      Input         : Multiple_Bytes;
      Success       : out Boolean)
   is
      Result : Integer;
   begin
      Send_Data (I2C_Sensor'Class (This), Base_Register, Input'Address, Input'Length, Result);
      Success := Result = 0;
   end Set_Multiple_Bytes;

end NXT.I2C_Sensors;
