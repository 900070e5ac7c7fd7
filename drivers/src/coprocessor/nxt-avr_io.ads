--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the processor and the co-processor tell each other, and how it is coded in bytes. Source of
--  the coding: the firmware that LEGO published for both sides.

with Interfaces;
with NXT.TWI;

package NXT.AVR_IO is

   Address : constant NXT.TWI.Device_Id := 1;

   --  Both directions end in a byte that makes the sum of all bytes 16#FF#, modulo 256.

   Output_Length : constant := 9;
   Input_Length  : constant := 13;
   subtype Output_Frame is NXT.TWI.Byte_Array (1 .. Output_Length);
   subtype Input_Frame  is NXT.TWI.Byte_Array (1 .. Input_Length);

   Greeting_Length : constant := 47;
   subtype Greeting_Frame is NXT.TWI.Byte_Array (1 .. Greeting_Length);

   function Greeting return Greeting_Frame;
   --  Must be sent once; without it the co-processor switches the brick off after five minutes.

   type Power_Command is (Stay_On, Switch_Off, Boot_Monitor);

   type Motor_Duties  is array (Motor_Id) of PWM_Value;
   type Motor_Brakes  is array (Motor_Id) of Boolean;
   type Sensor_Powers is array (Sensor_Id) of Sensor_Power;

   type Outputs is record
      Power         : Power_Command := Stay_On;
      Duties        : Motor_Duties  := (others => 0);
      Brakes        : Motor_Brakes  := (others => True);
      Sensor_Supply : Sensor_Powers := (others => Standard_Power);
   end record;
   --  Brakes: whether the windings are shorted while the bridge does not drive, which makes the
   --  mean voltage proportional to the duty cycle; without it the current dies out through the
   --  diodes. At duty 0 it is the choice between brake and coast.

   All_Stopped : constant Outputs;
   --  Every motor braked, every sensor supply off.

   type Sensor_Readings is array (Sensor_Id) of ADC_Value;

   type Inputs is record
      Sensors       : Sensor_Readings := (others => ADC_Value'Last);
      Pressed       : Button_Id := No_Button;
      Battery_Count : ADC_Value := 0;
      Rechargeable  : Boolean := False;
      Battery_Word  : Interfaces.Unsigned_16 := 0;
   end record;
   --  Battery_Word: as received; bits 10 to 14 hold the co-processor's firmware version.

   PWM_Frequency_kHz : constant := 8;

   function Encode (Values : Outputs) return Output_Frame;

   type Verdict is (Valid, Not_Sampled, Corrupt);
   --  Not_Sampled: the sum is right, but the co-processor has not begun to sample. Until then all
   --  ports read zero, which would be pressed touch sensors; sampled ports without a sensor read
   --  full scale. A battery that runs the brick never reads zero. Corrupt: the sum is wrong.

   procedure Decode (Frame : Input_Frame; Values : out Inputs; Judgement : out Verdict);
   --  Values are the defaults unless Judgement is Valid.

   function Decoded_Button (Reading : Interfaces.Unsigned_16) return Button_Id;
   --  The buttons are a voltage ladder; the orange one adds 16#7FF#.

   --  As known from GNAT for MINDSTORMS, for programs that do without NXT.AVR. Messages hold all
   --  outputs: what the calls before have set stays. Sending and receiving delay the caller.

   type Outgoing_AVR_Message is private;

   Null_Outgoing_Msg : constant Outgoing_AVR_Message;

   function Power_Down_Message return Outgoing_AVR_Message;

   function Set_Sensor_Power_Message
     (Port : Sensor_Id; Power_Type : Sensor_Power) return Outgoing_AVR_Message;

   function Set_Motor_Message
     (Motor : Motor_Id; Power : PWM_Value; Brake : Boolean) return Outgoing_AVR_Message;
   --  As NXT.AVR.Set_Power.

   procedure Send_Initialization;
   procedure Send_To_AVR (This : Outgoing_AVR_Message);

   type Incoming_AVR_Message is private;

   procedure Receive_From_AVR (This : out Incoming_AVR_Message; Valid : out Boolean);

   type Raw_ADC_Inputs is array (Sensor_Id) of Interfaces.Unsigned_16;

   function Raw_Inputs (From : Incoming_AVR_Message) return Raw_ADC_Inputs;
   function Decoded_Button (From : Incoming_AVR_Message) return Button_Id;
   function Battery_Reading (From : Incoming_AVR_Message) return Interfaces.Unsigned_16;

private

   All_Stopped : constant Outputs := (others => <>);

   type Outgoing_AVR_Message is new Outputs;
   type Incoming_AVR_Message is new Inputs;

   Null_Outgoing_Msg : constant Outgoing_AVR_Message := (others => <>);

end NXT.AVR_IO;
