--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Ultrasonic_Sensors is

   use Ada.Real_Time;

   Factory_Register     : constant := 16#11#;
   Units_Register       : constant := 16#14#;
   Interval_Register    : constant := 16#40#;
   Mode_Register        : constant := 16#41#;
   Distance_Register    : constant := 16#42#;
   Calibration_Register : constant := 16#4A#;

   Command_Distance : constant Time_Span := Milliseconds (5);
   Ping_Time        : constant Time_Span := Milliseconds (50);
   Reading_Distance : constant Time_Span := Milliseconds (30);

   procedure Await_Next_Command (This : Ultrasonic_Sensor) is
   begin
      delay until This.Next_Command;
   end Await_Next_Command;

   procedure Note_Command (This : in out Ultrasonic_Sensor; Result : Integer) is
   begin
      This.Next_Command := Clock + Command_Distance;
      if Result < 0 then
         This.Mode_Is_Pending := True;
      end if;
   end Note_Command;

   --  A sensor that did not answer may have been without supply: it is told its mode again.
   procedure Send_Pending_Mode (This : in out Ultrasonic_Sensor; Result : out Integer) is
      Code : constant Multiple_Bytes := (1 => Operating_Mode'Pos (This.Mode));
   begin
      Result := 0;
      if This.Mode_Is_Pending then
         Await_Next_Command (This);
         I2C_Sensor (This).Send_Data (Mode_Register, Code'Address, Code'Length, Result);
         This.Mode_Is_Pending := Result < 0;
         Note_Command (This, Result);
         This.Next_Reading :=
           Clock + (if This.Mode = Ping then Ping_Time else Reading_Distance);
      end if;
   end Send_Pending_Mode;

   overriding procedure Send_Data
     (This     : in out Ultrasonic_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer)
   is
   begin
      Send_Pending_Mode (This, Result);
      if Result = 0 then
         Await_Next_Command (This);
         I2C_Sensor (This).Send_Data (Register, Buffer, Length, Result);
         Note_Command (This, Result);
      end if;
   end Send_Data;

   overriding procedure Get_Data
     (This     : in out Ultrasonic_Sensor;
      Register : Unsigned_32;
      Buffer   : System.Address;
      Length   : Positive;
      Result   : out Integer)
   is
   begin
      Send_Pending_Mode (This, Result);
      if Result = 0 then
         Await_Next_Command (This);
         I2C_Sensor (This).Get_Data (Register, Buffer, Length, Result);
         Note_Command (This, Result);
      end if;
   end Get_Data;

   procedure Query_Current_Mode (This : in out Ultrasonic_Sensor; Mode : out Operating_Mode) is
      Code    : Multiple_Bytes (1 .. 1);
      Success : Boolean;
   begin
      This.Fetch_Multiple_Bytes (Mode_Register, Code, Success);
      if Success and then Code (1) <= Operating_Mode'Pos (Commanded_Operating_Mode'Last) then
         Mode := Operating_Mode'Val (Code (1));
      else
         Mode := Error;
      end if;
   end Query_Current_Mode;

   procedure Set_Mode (This : in out Ultrasonic_Sensor; Mode : Commanded_Operating_Mode) is
      Ignored : Integer;
   begin
      This.Mode := Mode;
      This.Mode_Is_Pending := True;
      Send_Pending_Mode (This, Ignored);
   end Set_Mode;

   function Commanded_Mode (This : Ultrasonic_Sensor) return Operating_Mode is (This.Mode);

   procedure Reset (This : in out Ultrasonic_Sensor) is
   begin
      Set_Mode (This, Reset);
   end Reset;

   procedure Ping (This : in out Ultrasonic_Sensor) is
   begin
      Set_Mode (This, Ping);
   end Ping;

   procedure Off (This : in out Ultrasonic_Sensor) is
   begin
      Set_Mode (This, Off);
   end Off;

   --  The first readings, when they are there.
   procedure Read_Distances
     (This : in out Ultrasonic_Sensor; Readings : out Multiple_Bytes; Success : out Boolean)
   is
      Result : Integer;
   begin
      Send_Pending_Mode (This, Result);
      delay until This.Next_Reading;
      This.Fetch_Multiple_Bytes (Distance_Register, Readings, Success);
      if This.Mode /= Ping then
         This.Next_Reading := Clock + Reading_Distance;
      end if;
   end Read_Distances;

   procedure Measure
     (This     : in out Ultrasonic_Sensor;
      Distance : out Centimetres;
      Status   : out Measurement_Status)
   is
      Readings : Multiple_Bytes (1 .. 1);
      Success  : Boolean;
   begin
      Read_Distances (This, Readings, Success);
      Distance := Centimetres'Last;
      if not Success then
         Status := No_Answer;
      elsif Readings (1) = Out_Of_Range then
         Status := No_Echo;
      else
         Status := Measured;
         Distance := Centimetres (Readings (1));
      end if;
   end Measure;

   procedure Require_Measuring (This : Ultrasonic_Sensor) is
   begin
      if This.Mode not in Ping .. Capture then
         raise Operating_Error with "NXT.Ultrasonic_Sensors: the sensor is off";
      end if;
   end Require_Measuring;

   procedure Get_Distance (This : in out Ultrasonic_Sensor; Reading : out Natural) is
      Distance : Centimetres;
      Status   : Measurement_Status;
   begin
      Require_Measuring (This);
      Measure (This, Distance, Status);
      Reading := (if Status = Measured then Natural (Distance) else Out_Of_Range);
   end Get_Distance;

   procedure Get_Distances
     (This     : in out Ultrasonic_Sensor;
      Readings : out Distances;
      Actual   : out Natural)
   is
   begin
      Get_Distances (This, Readings'Length, 0, Readings, Actual);
   end Get_Distances;

   procedure Get_Distances
     (This      : in out Ultrasonic_Sensor;
      Requested : Distances_Index;
      Offset    : Natural;
      Readings  : out Distances;
      Actual    : out Natural)
   is
      Found   : Multiple_Bytes (1 .. Requested);
      Success : Boolean;
   begin
      Require_Measuring (This);
      Read_Distances (This, Found, Success);
      Actual := 0;
      for Place in Found'Range loop
         if not Success then
            Found (Place) := Out_Of_Range;
         elsif Found (Place) /= Out_Of_Range then
            Actual := Actual + 1;
         end if;
         Readings (Readings'First + Offset + Place - 1) := Found (Place);
      end loop;
   end Get_Distances;

   procedure Get_Units
     (This : in out Ultrasonic_Sensor; Units : out Units_String; Success : out Boolean)
   is
      Letters : constant := 7;
   begin
      This.Fetch_String (Units_Register, Letters, Units, Success);
   end Get_Units;

   procedure Get_Factory_Data
     (This : in out Ultrasonic_Sensor; Info : out Data; Success : out Boolean)
   is
   begin
      This.Fetch_Multiple_Bytes (Factory_Register, Info, Success);
   end Get_Factory_Data;

   procedure Get_Calibration_Data
     (This : in out Ultrasonic_Sensor; Info : out Data; Success : out Boolean)
   is
   begin
      This.Fetch_Multiple_Bytes (Calibration_Register, Info, Success);
   end Get_Calibration_Data;

   procedure Set_Calibration_Data
     (This : in out Ultrasonic_Sensor; Info : Data; Success : out Boolean)
   is
   begin
      This.Set_Multiple_Bytes (Calibration_Register, Info, Success);
   end Set_Calibration_Data;

   procedure Get_Continuous_Interval
     (This : in out Ultrasonic_Sensor; Info : out Unsigned_8; Success : out Boolean)
   is
      Value : Multiple_Bytes (1 .. 1);
   begin
      This.Fetch_Multiple_Bytes (Interval_Register, Value, Success);
      Info := Value (1);
   end Get_Continuous_Interval;

   procedure Set_Continuous_Interval
     (This : in out Ultrasonic_Sensor; Info : Unsigned_8; Success : out Boolean)
   is
   begin
      This.Set_Multiple_Bytes (Interval_Register, Multiple_Bytes'(1 => Info), Success);
   end Set_Continuous_Interval;

end NXT.Ultrasonic_Sensors;
