--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;  use Interfaces;

package body NXT.AVR_IO is

   --  First byte of a frame from the processor
   Normal_Operation : constant := 16#00#;
   Power_Down       : constant := 16#5A#;
   Text_Follows     : constant := 16#CC#;
   Boot_Command     : constant := 16#A5#;
   --  With Power_Down in place of the frequency.

   Text : constant String := "Let's samba nxt arm in arm, (c)LEGO System A/S";
   pragma Compile_Time_Error (Text'Length + 1 /= Greeting_Length, "length of the greeting");

   --  Lowest readings of the button ladder; the middle between neighbouring buttons or lower
   Power_Threshold  : constant := 16#7FF#;
   Middle_Threshold : constant := 16#301#;
   Right_Threshold  : constant := 16#101#;
   Left_Threshold   : constant := 16#061#;

   Battery_Mask     : constant := 16#03FF#;
   Rechargeable_Bit : constant := 16#8000#;

   function Greeting return Greeting_Frame is
   begin
      return Frame : Greeting_Frame do
         Frame (1) := Text_Follows;
         for Position in Text'Range loop
            Frame (1 + Position) := Character'Pos (Text (Position));
         end loop;
      end return;
   end Greeting;

   function Sum (Bytes : NXT.TWI.Byte_Array) return Unsigned_8 is
   begin
      return Total : Unsigned_8 := 0 do
         for Value of Bytes loop
            pragma Annotate (Ravenbrick, Iterations, 13, "the longer of both frames with a sum");
            Total := Total + Value;
         end loop;
      end return;
   end Sum;

   function Two_Complement (Duty : PWM_Value) return Unsigned_8 is
     (Unsigned_8 (Integer (Duty) mod 256));

   function Brake_Bits (Brakes : Motor_Brakes) return Unsigned_8 is
   begin
      return Mode : Unsigned_8 := 0 do
         for Motor in Motor_Id loop
            if Brakes (Motor) then
               Mode := Mode or 2 ** Motor_Id'Pos (Motor);
            end if;
         end loop;
      end return;
   end Brake_Bits;

   --  Bits 0 to 3: 9 V except while sampling, ports 1 to 4; bits 4 to 7: 9 V always.
   function Supply_Bits (Supply : Sensor_Powers) return Unsigned_8 is
   begin
      return Mode : Unsigned_8 := 0 do
         for Sensor in Sensor_Id loop
            case Supply (Sensor) is
               when Standard_Power => null;
               when RCX_9V => Mode := Mode or 2 ** Sensor_Id'Pos (Sensor);
               when NXT_9V => Mode := Mode or 2 ** (4 + Sensor_Id'Pos (Sensor));
            end case;
         end loop;
      end return;
   end Supply_Bits;

   function Encode (Values : Outputs) return Output_Frame is
   begin
      return Frame : Output_Frame := (others => 0) do
         Frame (1) := (case Values.Power is
                          when Stay_On => Normal_Operation,
                          when Switch_Off => Power_Down,
                          when Boot_Monitor => Boot_Command);
         Frame (2) := (if Values.Power = Boot_Monitor then Power_Down else PWM_Frequency_kHz);
         Frame (3) := Two_Complement (Values.Duties (Motor_A));
         Frame (4) := Two_Complement (Values.Duties (Motor_B));
         Frame (5) := Two_Complement (Values.Duties (Motor_C));
         Frame (7) := Brake_Bits (Values.Brakes);
         Frame (8) := Supply_Bits (Values.Sensor_Supply);
         Frame (9) := not Sum (Frame);
      end return;
   end Encode;

   function Decoded_Button (Reading : Unsigned_16) return Button_Id is
     (if Reading >= Power_Threshold then Power_Button
      elsif Reading >= Middle_Threshold then Middle_Button
      elsif Reading >= Right_Threshold then Right_Button
      elsif Reading >= Left_Threshold then Left_Button
      else No_Button);

   --  The 16-bit number in little-endian order at a place of the frame.
   function Word_At (Frame : Input_Frame; Place : Positive) return Unsigned_16 is
     (Unsigned_16 (Frame (Place)) + 256 * Unsigned_16 (Frame (Place + 1)));

   --  A frame from before the first sampling: LEGO's co-processor has measured the battery then,
   --  but no port.
   function Is_Unsampled (Frame : Input_Frame; Battery : Unsigned_16) return Boolean is
     ((Battery and Battery_Mask) = 0
      or else (Word_At (Frame, 1) or Word_At (Frame, 3) or Word_At (Frame, 5)
               or Word_At (Frame, 7)) = 0);

   procedure Decode (Frame : Input_Frame; Values : out Inputs; Judgement : out Verdict) is
      Battery : constant Unsigned_16 := Word_At (Frame, 11);
   begin
      Values := (others => <>);
      Judgement := (if Sum (Frame) /= 16#FF# then Corrupt
                    elsif Is_Unsampled (Frame, Battery) then Not_Sampled
                    else Valid);
      if Judgement = Valid then
         for Sensor in Sensor_Id loop
            Values.Sensors (Sensor) :=
              ADC_Value (Word_At (Frame, 1 + 2 * Sensor_Id'Pos (Sensor)) mod 1024);
         end loop;
         Values.Pressed := Decoded_Button (Word_At (Frame, 9));
         Values.Battery_Count := ADC_Value (Battery and Battery_Mask);
         Values.Rechargeable := (Battery and Rechargeable_Bit) /= 0;
         Values.Battery_Word := Battery;
      end if;
   end Decode;

   --  What messages hold besides what they set
   Retained : Outgoing_AVR_Message := Null_Outgoing_Msg;

   function Power_Down_Message return Outgoing_AVR_Message is
     (Power => Switch_Off, others => <>);

   function Set_Sensor_Power_Message
     (Port : Sensor_Id; Power_Type : Sensor_Power) return Outgoing_AVR_Message is
   begin
      Retained.Sensor_Supply (Port) := Power_Type;
      return Retained;
   end Set_Sensor_Power_Message;

   function Set_Motor_Message
     (Motor : Motor_Id; Power : PWM_Value; Brake : Boolean) return Outgoing_AVR_Message is
   begin
      Retained.Duties (Motor) := Power;
      Retained.Brakes (Motor) := Brake or else Power /= 0;
      return Retained;
   end Set_Motor_Message;

   procedure Send_Initialization is
      Text : constant Greeting_Frame := Greeting;
   begin
      NXT.TWI.Send (Address, 0, Text'Address, Text'Length);
   end Send_Initialization;

   procedure Send_To_AVR (This : Outgoing_AVR_Message) is
      Frame : constant Output_Frame := Encode (Outputs (This));
   begin
      NXT.TWI.Send (Address, 0, Frame'Address, Frame'Length);
   end Send_To_AVR;

   procedure Receive_From_AVR (This : out Incoming_AVR_Message; Valid : out Boolean) is
      Frame     : Input_Frame;
      Judgement : Verdict;
   begin
      NXT.TWI.Recv (Address, 0, Frame'Address, Frame'Length);
      Decode (Frame, Inputs (This), Judgement);
      Valid := Judgement = AVR_IO.Valid;
   end Receive_From_AVR;

   function Raw_Inputs (From : Incoming_AVR_Message) return Raw_ADC_Inputs is
   begin
      return Result : Raw_ADC_Inputs do
         for Port in Sensor_Id loop
            Result (Port) := Unsigned_16 (From.Sensors (Port));
         end loop;
      end return;
   end Raw_Inputs;

   function Decoded_Button (From : Incoming_AVR_Message) return Button_Id is (From.Pressed);

   function Battery_Reading (From : Incoming_AVR_Message) return Unsigned_16 is
     (From.Battery_Word);

end NXT.AVR_IO;
