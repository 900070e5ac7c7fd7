--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The root of all sensors on a two-wire bus: objects that know their port and the address of the
--  chip in them. Extend it for a sensor of your own. Operations suspend the caller until the
--  transaction has ended; one task at a time may use a sensor.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

with Interfaces;  use Interfaces;
with System;

package NXT.I2C_Sensors is

   type I2C_Sensor is abstract tagged private;

   procedure Set_Port_Id (This : in out I2C_Sensor; To : Sensor_Id);
   function Port (This : I2C_Sensor) return Sensor_Id;

   procedure Set_Device_Address (This : in out I2C_Sensor; To : Unsigned_32);
   function Device (This : I2C_Sensor) return Unsigned_32;
   --  Address byte of a write, that is twice the 7-bit address; 2 if never set.

   procedure Send_Data
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer);
   --  Write Length bytes into registers from Register on. Result is 0 or negative: see
   --  NXT.I2C_Ports.

   procedure Get_Data
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer);
   --  Read Length registers from Register on; likewise.

   subtype Query_Reply is String (1 .. 8);

   procedure Get_Version
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean);
   procedure Get_Product_Id
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean);
   procedure Get_Sensor_Type
     (This : in out I2C_Sensor; Result : out Query_Reply; Success : out Boolean);
   --  What all LEGO sensors tell about themselves; ends in NULs. Blanks without Success.

   procedure Fetch_String
     (This     : in out I2C_Sensor;
      Register : Unsigned_32;
      Length   : Positive;
      Fetched  : out Query_Reply;
      Success  : out Boolean)
     with Pre'Class => Length <= Query_Reply'Length;
   --  Text from registers, with blanks up to the end of Fetched.

   type Multiple_Bytes is array (Positive range <>) of Unsigned_8;

   procedure Fetch_Multiple_Bytes
     (This          : in out I2C_Sensor;
      Base_Register : Unsigned_32;
      Output        : out Multiple_Bytes;
      Success       : out Boolean);
   --  Zeros without Success.

   procedure Set_Multiple_Bytes
     (This          : in out I2C_Sensor;
      Base_Register : Unsigned_32;
      Input         : Multiple_Bytes;
      Success       : out Boolean);

private

   type I2C_Sensor is abstract tagged record
      Port_Id        : Sensor_Id := Sensor_1;
      Device_Address : Unsigned_32 := 2;
   end record;

end NXT.I2C_Sensors;
