--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;

package body NXT.I2C_Lines is

   use Interfaces;

   Acknowledge_Bit : constant := 9;

   --  Ticks for which a sensor may hold the clock, 5 ms
   Patience : constant := 100;

   --  Ticks before each byte that give LEGO's sensors time
   Pause_Before_Byte : constant := 2;

   type Masks is array (Sensor_Id) of Word;
   Clock_Masks : constant Masks :=
     (Bit (Digital_0 (Sensor_1)), Bit (Digital_0 (Sensor_2)), Bit (Digital_0 (Sensor_3)),
      Bit (Digital_0 (Sensor_4)));
   Data_Masks : constant Masks :=
     (Bit (Digital_1 (Sensor_1)), Bit (Digital_1 (Sensor_2)), Bit (Digital_1 (Sensor_3)),
      Bit (Digital_1 (Sensor_4)));

   procedure Put (Mask : Word; High : Boolean) with Inline;

   procedure Put (Mask : Word; High : Boolean) is
   begin
      if High then
         PIOA.PIO_SODR := Mask;
      else
         PIOA.PIO_CODR := Mask;
      end if;
   end Put;

   procedure Take_Lines (Port : Sensor_Id) is
      Both : constant Word := Clock_Masks (Port) or Data_Masks (Port);
   begin
      PIOA.PIO_PUDR := Both;
      PIOA.PIO_MDER := Both;
      PIOA.PIO_SODR := Both;
      PIOA.PIO_OER := Both;
      PIOA.PIO_PER := Both;
   end Take_Lines;

   function Free (Port : Sensor_Id) return Boolean is
      Both : constant Word := Clock_Masks (Port) or Data_Masks (Port);
   begin
      return (PIOA.PIO_PDSR and Both) = Both;
   end Free;

   procedure Begin_Transfer (This : in out Bus) is
   begin
      This.Failed := False;
      This.Output_Next := 1;
      This.Input_Count := 0;
      This.Receiving := False;
      This.Waits := 0;
      This.Pending := Start;
      This.State := Condition;
   end Begin_Transfer;

   procedure Finish (This : in out Bus; Port : Sensor_Id) is
   begin
      PIOA.PIO_SODR := Clock_Masks (Port) or Data_Masks (Port);
      This.State := Idle;
   end Finish;

   procedure Fail (This : in out Bus; Port : Sensor_Id) is
   begin
      This.Failed := True;
      Finish (This, Port);
   end Fail;

   --  The clock goes down, and the data where the condition begins: it is a change of the data
   --  while the clock is high.
   procedure Set_Up_Condition (This : in out Bus; Port : Sensor_Id) is
   begin
      Put (Clock_Masks (Port), High => False);
      Put (Data_Masks (Port), High => This.Pending = Start);
      This.State := Condition_Clock;
   end Set_Up_Condition;

   procedure Prepare (This : in out Bus; Wanted : Bus_Condition; Port : Sensor_Id) is
   begin
      This.Pending := Wanted;
      Set_Up_Condition (This, Port);
   end Prepare;

   --  The clock goes down and the next bit is put; Waits are the ticks until the clock rises.
   procedure Set_Up_Bit (This : in out Bus; Port : Sensor_Id) is
      Last : constant Boolean := This.Input_Count + 1 = This.Input_Length;
   begin
      Put (Clock_Masks (Port), High => False);
      if This.Bits = Acknowledge_Bit - 1 then
         Put (Data_Masks (Port), High => not This.Receiving or else Last);
      else
         Put (Data_Masks (Port), High => This.Receiving or else This.Shift >= 16#80#);
      end if;
      This.State := Bit_Clock;
   end Set_Up_Bit;

   procedure Set_Up_Byte (This : in out Bus; Value : Byte; Port : Sensor_Id) is
   begin
      This.Shift := Value;
      This.Bits := 0;
      This.Waits := (if This.LEGO_Mode then Pause_Before_Byte else 0);
      Set_Up_Bit (This, Port);
   end Set_Up_Byte;

   procedure Set_Up_First_Byte (This : in out Bus; Port : Sensor_Id) is
   begin
      if This.Output_Next > This.Output_Last then
         Set_Up_Byte (This, This.Read_Address, Port);
      else
         Set_Up_Byte (This, This.Output (This.Output_Next), Port);
      end if;
   end Set_Up_First_Byte;

   procedure After_Byte_Sent (This : in out Bus; Acknowledged : Boolean; Port : Sensor_Id) is
      Was_Read_Address : constant Boolean := This.Output_Next > This.Output_Last;
   begin
      if not Acknowledged then
         This.Failed := True;
         Prepare (This, Stop, Port);
      elsif Was_Read_Address then
         This.Receiving := True;
         Set_Up_Byte (This, 0, Port);
      else
         This.Output_Next := This.Output_Next + 1;
         if This.Output_Next <= This.Output_Last then
            Set_Up_Byte (This, This.Output (This.Output_Next), Port);
         elsif This.Input_Length > 0 and then not This.LEGO_Mode then
            Prepare (This, Start, Port);
         else
            Prepare (This, Stop, Port);
         end if;
      end if;
   end After_Byte_Sent;

   procedure After_Byte_Received (This : in out Bus; Port : Sensor_Id) is
   begin
      This.Input_Count := This.Input_Count + 1;
      This.Input (This.Input_Count) := This.Shift;
      if This.Input_Count < This.Input_Length then
         Set_Up_Byte (This, 0, Port);
      elsif This.LEGO_Mode then
         Finish (This, Port);
      else
         Prepare (This, Stop, Port);
      end if;
   end After_Byte_Received;

   --  The clock is high: take the bit, then let the clock fall with the next one.
   procedure Sample (This : in out Bus; Levels : Word; Port : Sensor_Id) is
      High : constant Boolean := Has (Levels, Data_Masks (Port));
   begin
      This.Bits := This.Bits + 1;
      if This.Bits < Acknowledge_Bit then
         This.Shift := 2 * This.Shift + (if This.Receiving and then High then 1 else 0);
         Set_Up_Bit (This, Port);
      elsif This.Receiving then
         After_Byte_Received (This, Port);
      else
         After_Byte_Sent (This, not High, Port);
      end if;
   end Sample;

   procedure Make_Condition (This : in out Bus; Port : Sensor_Id) is
      Read_Follows : constant Boolean := This.Input_Length > 0 and then not This.Receiving;
   begin
      Put (Data_Masks (Port), High => This.Pending = Stop);
      if This.Pending = Start then
         This.State := Bit_Setup;
      elsif Read_Follows and then not This.Failed then
         This.Pending := Start;
         This.State := Condition_Setup;
      else
         Finish (This, Port);
      end if;
   end Make_Condition;

   --  A sensor may hold the clock low for a while.
   procedure Proceed_When_Clock_Is_High (This : in out Bus; Port : Sensor_Id) is
      Levels : constant Word := PIOA.PIO_PDSR;
   begin
      if not Has (Levels, Clock_Masks (Port)) then
         This.Waits := This.Waits + 1;
         if This.Waits > Patience then
            Fail (This, Port);
         end if;
      else
         This.Waits := 0;
         if This.State = Bit_Sample then
            Sample (This, Levels, Port);
         else
            Make_Condition (This, Port);
         end if;
      end if;
   end Proceed_When_Clock_Is_High;

   procedure Raise_Clock (This : in out Bus; Then_Enter : Bus_State; Port : Sensor_Id) is
   begin
      if This.Waits > 0 then
         This.Waits := This.Waits - 1;
      else
         Put (Clock_Masks (Port), High => True);
         This.State := Then_Enter;
      end if;
   end Raise_Clock;

   procedure Tick (This : in out Bus; Port : Sensor_Id) is
   begin
      case This.State is
         when Idle                   => null;
         when Condition_Setup        => Set_Up_Condition (This, Port);
         when Condition_Clock        => Raise_Clock (This, Condition, Port);
         when Bit_Setup              => Set_Up_First_Byte (This, Port);
         when Bit_Clock              => Raise_Clock (This, Bit_Sample, Port);
         when Condition | Bit_Sample => Proceed_When_Clock_Is_High (This, Port);
      end case;
   end Tick;

end NXT.I2C_Lines;
