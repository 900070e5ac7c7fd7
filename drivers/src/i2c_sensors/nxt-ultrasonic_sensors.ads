--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The ultrasonic sensor of the NXT set (NXT Hardware Developer Kit, appendix of the sensor).
--  NXT.Ultrasonic_Sensors.Ctors makes sensors. Operations delay the calling task until the sensor
--  can take the next command and until its readings are there: 5 ms after a command, 50 ms after a
--  ping, 30 ms between readings otherwise.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

with Ada.Real_Time;
with Interfaces;       use Interfaces;
with NXT.I2C_Sensors;  use NXT.I2C_Sensors;
with System;

package NXT.Ultrasonic_Sensors is

   type Ultrasonic_Sensor (<>) is new I2C_Sensor with private;

   type Operating_Mode is (Off, Ping, Continuous, Capture, Reset, Error);
   --  In the order of the sensor's codes; Error stands for no answer.

   subtype Commanded_Operating_Mode is Operating_Mode range Off .. Reset;

   procedure Query_Current_Mode (This : in out Ultrasonic_Sensor; Mode : out Operating_Mode);
   --  Ask the sensor.

   procedure Set_Mode (This : in out Ultrasonic_Sensor; Mode : Commanded_Operating_Mode);
   --  Command the sensor. Ping sends one ping, Reset restarts the sensor's program and leaves it
   --  off. A command that is not answered is repeated with the next operation.

   function Commanded_Mode (This : Ultrasonic_Sensor) return Operating_Mode;

   procedure Reset (This : in out Ultrasonic_Sensor);
   procedure Ping (This : in out Ultrasonic_Sensor);
   procedure Off (This : in out Ultrasonic_Sensor);
   --  Set_Mode of that mode.

   --  Recommended

   type Centimetres is range 0 .. 254;

   type Measurement_Status is (Measured, No_Echo, No_Answer);

   procedure Measure
     (This     : in out Ultrasonic_Sensor;
      Distance : out Centimetres;
      Status   : out Measurement_Status)
     with Pre => Commanded_Mode (This) in Ping .. Capture;
   --  The nearest distance that was measured last. Distance is Centimetres'Last unless Status is
   --  Measured.

   --  As known from GNAT for MINDSTORMS

   Out_Of_Range : constant := 255;

   procedure Get_Distance (This : in out Ultrasonic_Sensor; Reading : out Natural);
   --  In centimetres; Out_Of_Range without an echo or an answer. Operating_Error while off.

   subtype Distances_Index is Integer range 1 .. 8;
   type Distances is array (Distances_Index range <>) of Unsigned_8;

   procedure Get_Distances
     (This     : in out Ultrasonic_Sensor;
      Readings : out Distances;
      Actual   : out Natural);

   procedure Get_Distances
     (This      : in out Ultrasonic_Sensor;
      Requested : Distances_Index;
      Offset    : Natural;
      Readings  : out Distances;
      Actual    : out Natural)
     with Pre => Offset + Requested <= Readings'Length;
   --  Distances of the first echoes, Actual of them, at most Requested, in centimetres from
   --  Readings (Readings'First + Offset) on; the others of Requested are 255. After a ping there
   --  may be several. Operating_Error while off.

   Operating_Error : exception;

   subtype Units_String is String (1 .. 8);

   procedure Get_Units
     (This : in out Ultrasonic_Sensor; Units : out Units_String; Success : out Boolean);
   --  "10E-2m": centimetres.

   subtype Data is Multiple_Bytes (1 .. 3);
   --  Zero, scale factor and scale divisor.

   procedure Get_Factory_Data
     (This : in out Ultrasonic_Sensor; Info : out Data; Success : out Boolean);
   procedure Get_Calibration_Data
     (This : in out Ultrasonic_Sensor; Info : out Data; Success : out Boolean);
   procedure Set_Calibration_Data
     (This : in out Ultrasonic_Sensor; Info : Data; Success : out Boolean);

   procedure Get_Continuous_Interval
     (This : in out Ultrasonic_Sensor; Info : out Unsigned_8; Success : out Boolean);
   procedure Set_Continuous_Interval
     (This : in out Ultrasonic_Sensor; Info : Unsigned_8; Success : out Boolean);

private

   type Ultrasonic_Sensor is new I2C_Sensor with record
      Mode            : Commanded_Operating_Mode;
      Mode_Is_Pending : Boolean;
      Next_Command    : Ada.Real_Time.Time;
      Next_Reading    : Ada.Real_Time.Time;
   end record;

   overriding procedure Send_Data
     (This     : in out Ultrasonic_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer);

   overriding procedure Get_Data
     (This     : in out Ultrasonic_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer);
   --  Keep the distance between commands and send a mode that waits.

end NXT.Ultrasonic_Sensors;
