--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Direct_Commands.Low_Speed;
with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Direct_Commands.Inputs is

   --  Kinds
   No_Sensor   : constant Byte := 16#00#;
   Switch      : constant Byte := 16#01#;
   Light_On    : constant Byte := 16#05#;
   Light_Off   : constant Byte := 16#06#;
   Sound       : constant Byte := 16#07#;
   Sound_Heard : constant Byte := 16#08#;
   Custom      : constant Byte := 16#09#;
   On_Bus      : constant Byte := 16#0A#;
   On_Bus_9V   : constant Byte := 16#0B#;

   --  Modes
   Mode_Mask   : constant Byte := 16#E0#;
   Raw_Mode    : constant Byte := 16#00#;
   Truth_Mode  : constant Byte := 16#20#;
   Share_Mode  : constant Byte := 16#80#;

   Success      : constant Byte := 16#00#;
   Out_Of_Range : constant Byte := 16#C0#;

   Full_Scale      : constant := 1_023;
   Switch_Threshold : constant := 460;
   --  A pressed touch sensor reads about 180, a free one 1023.

   type Setting is record
      Kind : Byte := No_Sensor;
      Mode : Byte := Raw_Mode;
   end record;

   Settings : array (Sensor_Id) of Setting;

   --  Both lines of a sensor: the first one lights the light sensor and makes the sound sensor
   --  hear plainly, the second makes it hear as the ear does.
   procedure Drive_Lines (Port : Sensor_Id; First, Second : Pin_States) is
   begin
      Set_Pin_State (Port, Digital_0, First);
      Set_Pin_State (Port, Digital_1, Second);
      Set_Pin_Mode (Port, Digital_0, Output);
      Set_Pin_Mode (Port, Digital_1, Output);
   end Drive_Lines;

   procedure Set (Port, Kind, Mode : Byte; Status : out Byte) is
      Sensor : constant Sensor_Id := Sensor_Id'Val (Port);
   begin
      Status := Success;
      Low_Speed.Close (Sensor);
      case Kind is
         when No_Sensor | Switch | Custom => Reset (Sensor);
         when Light_On    => Drive_Lines (Sensor, High, Low);
         when Light_Off   => Drive_Lines (Sensor, Low, Low);
         when Sound       => Drive_Lines (Sensor, High, Low);
         when Sound_Heard => Drive_Lines (Sensor, Low, High);
         when On_Bus      => Low_Speed.Open (Sensor, Standard_Power);
         when On_Bus_9V   => Low_Speed.Open (Sensor, NXT_9V);
         when others      => Status := Out_Of_Range;
      end case;
      if (Mode and Mode_Mask) not in Raw_Mode | Truth_Mode | Share_Mode then
         Status := Out_Of_Range;
      end if;
      if Status = Success then
         Settings (Sensor) := (Kind, Mode);
      end if;
   end Set;

   --  More light and more sound lower the voltage; so does a press.
   function Scaled (Item : Setting; Raw : Unsigned_16) return Unsigned_16 is
     (case Item.Mode and Mode_Mask is
         when Truth_Mode => (if Raw < Switch_Threshold then 1 else 0),
         when Share_Mode => Unsigned_16 (Unsigned_32 (Full_Scale - Raw) * 100 / Full_Scale),
         when others     => Raw);

   function Values (Port : Byte) return Byte_Array is
      Sensor : constant Sensor_Id := Sensor_Id'Val (Port);
      Item   : Setting renames Settings (Sensor);
      Raw    : constant Unsigned_16 := NXT.AVR.Raw_Input (Sensor);
      Valid  : constant Byte := Boolean'Pos (NXT.AVR.Data_Available);
      Result : constant Two_Bytes := To_Bytes (Scaled (Item, Raw));
   begin
      return (Port, Valid, 0, Item.Kind, Item.Mode) & To_Bytes (Raw) & To_Bytes (Raw) & Result
        & Result;
   end Values;

end NXT.Direct_Commands.Inputs;
