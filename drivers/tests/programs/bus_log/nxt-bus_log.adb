--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;         use Interfaces;
with NXT.I2C_Lines;      use NXT.I2C_Lines;
with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;

package body NXT.Bus_Log is

   use type Word;

   Port  : constant Sensor_Id := Sensor_1;
   Clock : constant Word := Bit (Digital_0 (Port));
   Data  : constant Word := Bit (Digital_1 (Port));

   --  One line for each scenario, ended by a line feed
   Log : String (1 .. 1_024) := (others => ASCII.NUL) with
     Export, Convention => C, External_Name => "bus_log";
   Last : Natural := 0;

   procedure Note (Text : String) is
   begin
      Log (Last + 1 .. Last + Text'Length) := Text;
      Last := Last + Text'Length;
   end Note;

   Hex : constant String (1 .. 16) := "0123456789ABCDEF";

   procedure Note_Number (Value : Natural; Digit_Count : Positive; Base : Positive := 16) is
   begin
      for Place in reverse 0 .. Digit_Count - 1 loop
         Note ((1 => Hex (1 + Value / Base ** Place mod Base)));
      end loop;
   end Note_Number;

   --  What the peripheral does: it acknowledges Acknowledged bytes and sends First, First + 1, ...
   --  After Held_Bits bits it holds the clock for Held_Ticks ticks.
   type Script is record
      Acknowledged : Natural := 100;
      First        : Unsigned_8 := 0;
      Held_Bits    : Natural := Natural'Last;
      Held_Ticks   : Natural := 0;
   end record;

   type Peripheral is record
      Script   : Bus_Log.Script;
      Level_C  : Boolean := True;
      Level_D  : Boolean := True;
      Low_D    : Boolean := False;
      Low_C    : Boolean := False;
      Started  : Boolean := False;
      Sending  : Boolean := False;
      Bytes    : Natural := 0;
      Bits     : Natural := 0;
      All_Bits : Natural := 0;
      Value    : Unsigned_8 := 0;
      Next     : Unsigned_8 := 0;
   end record;
   --  Level: of the lines after the tick before. Low: pulled down by the peripheral.

   procedure Take_Condition (This : in out Peripheral; Is_Start : Boolean) is
   begin
      Note (if Is_Start then "S " else "P ");
      This.Started := Is_Start;
      This.Sending := False;
      This.Bits := 0;
      This.Bytes := 0;
      This.Low_D := False;
   end Take_Condition;

   procedure Take_Bit (This : in out Peripheral; High : Boolean) is
   begin
      This.All_Bits := This.All_Bits + 1;
      This.Bits := This.Bits + 1;
      if This.Bits < 9 then
         This.Value := This.Value * 2 + Boolean'Pos (High);
      else
         Note_Number (Natural (This.Value), 2);
         Note (if High then "n " else "a ");
         This.Bits := 0;
         This.Bytes := This.Bytes + 1;
         This.Sending := not High
           and then (This.Sending or else (This.Bytes = 1 and then (This.Value and 1) = 1));
      end if;
   end Take_Bit;

   --  The clock has fallen: the peripheral puts its next bit.
   procedure Put_Bit (This : in out Peripheral) is
      Mask : constant Unsigned_8 := Shift_Right (16#80#, This.Bits);
   begin
      if This.Bits = 8 then
         This.Low_D := not This.Sending and then This.Script.Acknowledged > 0;
         if This.Low_D then
            This.Script.Acknowledged := This.Script.Acknowledged - 1;
         end if;
      else
         if This.Sending and then This.Bits = 0 then
            This.Next := This.Script.First;
            This.Script.First := This.Script.First + 1;
         end if;
         This.Low_D := This.Sending and then (This.Next and Mask) = 0;
      end if;
      This.Low_C := This.All_Bits >= This.Script.Held_Bits and then This.Script.Held_Ticks > 0;
   end Put_Bit;

   procedure Follow (This : in out Peripheral; Master : Word) is
      Level_C : constant Boolean := Has (Master, Clock) and then not This.Low_C;
      Level_D : constant Boolean := Has (Master, Data) and then not This.Low_D;
   begin
      if Level_C and then This.Level_C and then Level_D /= This.Level_D then
         Take_Condition (This, Is_Start => not Level_D);
      elsif Level_C and then not This.Level_C and then This.Started then
         Take_Bit (This, Level_D);
      elsif This.Level_C and then not Level_C and then This.Started then
         Put_Bit (This);
      end if;
      This.Level_C := Level_C;
      This.Level_D := Has (Master, Data) and then not This.Low_D;
      if This.Low_C and then Has (Master, Clock) then
         This.Script.Held_Ticks := This.Script.Held_Ticks - 1;
         This.Low_C := This.Script.Held_Ticks > 0;
         if not This.Low_C then
            This.Level_C := True;
            Take_Bit (This, This.Level_D);
         end if;
      end if;
   end Follow;

   procedure Put (Levels : Word) is
   begin
      PIOA.PIO_SODR := Levels and (Clock or Data);
      PIOA.PIO_CODR := not Levels and (Clock or Data);
   end Put;

   --  The master reads the lines in two of its states, before it writes to them. The peripheral's
   --  lows are on the lines for just these moments, since both share the output registers; a state
   --  that stays wrote nothing.
   procedure Perform (Name : String; Behaviour : Script; Master : in out Bus) is
      Slave  : Peripheral := (Script => Behaviour, others => <>);
      Levels : Word := Clock or Data;
      State  : Bus_State;
      Ticks  : Natural := 0;
      Limit  : constant := 4_000;
   begin
      Note (Name & ": ");
      Take_Lines (Port);
      Begin_Transfer (Master);
      while Master.State /= Idle and then Ticks < Limit loop
         State := Master.State;
         if State in Condition | Bit_Sample then
            Put (Levels and not (if Slave.Low_C then Clock else 0)
                 and not (if Slave.Low_D then Data else 0));
         end if;
         Tick (Master, Port);
         if State in Condition | Bit_Sample and then Master.State = State then
            Put (Levels);
         end if;
         Levels := PIOA.PIO_PDSR and (Clock or Data);
         Follow (Slave, Levels);
         Ticks := Ticks + 1;
      end loop;
      Note (if Master.Failed then "failed" else "done");
      for Place in 1 .. Master.Input_Count loop
         Note (" ");
         Note_Number (Natural (Master.Input (Place)), 2);
      end loop;
      Note (" ticks ");
      Note_Number (Ticks, 3, Base => 10);
      Note ((1 => ASCII.LF));
   end Perform;

   function Write_Of (Bytes : I2C_Lines.Byte_Array; LEGO : Boolean := False) return Bus is
   begin
      return Result : Bus do
         Result.LEGO_Mode := LEGO;
         Result.Output (1 .. Bytes'Length) := Bytes;
         Result.Output_Last := Bytes'Length;
      end return;
   end Write_Of;

   function Read_Of
     (Device, Register : Byte; Length : Positive; LEGO : Boolean := False) return Bus is
   begin
      return Result : Bus := Write_Of ((Device, Register), LEGO) do
         Result.Input_Length := Length;
         Result.Read_Address := Device + 1;
      end return;
   end Read_Of;

   procedure Run (Name : String; Behaviour : Script; Master : Bus) is
      Copy : Bus := Master;
   begin
      Perform (Name, Behaviour, Copy);
   end Run;

   procedure Run_Scenarios is
      Willing : constant Script := (others => <>);
   begin
      PMC.PMC.PMC_PCER := Bit (PIOA_Id);
      Run ("write", Willing, Write_Of ((16#02#, 16#41#, 16#02#)));
      Run ("read", (First => 16#5A#, others => <>), Read_Of (16#02#, 16#42#, 2));
      Run ("LEGO read", (First => 16#5A#, others => <>), Read_Of (16#02#, 16#42#, 2, LEGO => True));
      Run ("nobody", (Acknowledged => 0, others => <>), Write_Of ((16#02#, 16#41#)));
      Run ("NACK of a register", (Acknowledged => 1, others => <>), Read_Of (16#02#, 16#42#, 1));
      Run ("NACK of the read", (Acknowledged => 2, others => <>), Read_Of (16#02#, 16#42#, 1));
      Run ("unplugged in the data", (First => 16#FF#, others => <>), Read_Of (16#02#, 16#42#, 1));
      Run ("stretched", (Held_Bits => 12, Held_Ticks => 20, others => <>),
           Write_Of ((16#02#, 16#41#)));
      Run ("stuck", (Held_Bits => 12, Held_Ticks => 3_000, others => <>),
           Write_Of ((16#02#, 16#41#)));
   end Run_Scenarios;

end NXT.Bus_Log;
