--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A program that talks to the co-processor itself, as with GNAT GPL for MINDSTORMS.

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT;            use NXT;
with NXT.AVR_IO;     use NXT.AVR_IO;
with NXT.TWI;

procedure Link_Messages is

   Button  : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "button";
   Sensor  : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "sensor";
   Battery : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "battery";
   Invalid : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "invalid";

   Message : Incoming_AVR_Message;
   Valid   : Boolean;

   procedure Pause is
   begin
      delay until Clock + Milliseconds (10);
   end Pause;

begin
   Send_Initialization;
   Pause;
   Send_To_AVR (Null_Outgoing_Msg);
   NXT.TWI.Send (NXT.AVR_IO.Address, 0, Button'Address, Msg_Len => 0);
   Send_To_AVR (Set_Sensor_Power_Message (Sensor_1, NXT_9V));
   Pause;
   Send_To_AVR (Set_Motor_Message (Motor_A, 40, True));
   Pause;
   Send_To_AVR (Set_Motor_Message (Motor_C, -30, True));
   for Round in 1 .. 50 loop
      Pause;
      Receive_From_AVR (Message, Valid);
      if Valid then
         Button := Button_Id'Pos (Decoded_Button (Message));
         Sensor := Integer (Raw_Inputs (Message) (Sensor_1));
         Battery := Integer (Battery_Reading (Message) and 16#3FF#);
      elsif Battery > 0 then
         Invalid := Invalid + 1;
      end if;
   end loop;
   loop
      Send_To_AVR (Power_Down_Message);
      Pause;
   end loop;
end Link_Messages;
