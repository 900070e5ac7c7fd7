--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Ada.Synchronous_Task_Control;  use Ada.Synchronous_Task_Control;
with NXT.I2C_Lines;                 use NXT.I2C_Lines;
with NXT.Priorities;
with NXT.Registers.PMC;
with NXT.Registers.TC;              use NXT.Registers, NXT.Registers.TC;
with NXT.Sensor_Ports;

package body NXT.I2C_Ports is

   pragma Compile_Time_Error (Maximum_Length /= Longest_Data, "length of a transaction");

   Bits_Per_Second : constant := 9_600;
   Counts_Per_Tick : constant := Clock_Hz / (2 * Bits_Per_Second);

   Read_Direction   : constant := 1;

   Ended : array (Sensor_Id) of Suspension_Object;

   type Bus_Table  is array (Sensor_Id) of Bus;
   type Flag_Table is array (Sensor_Id) of Boolean;

   subtype Port_Count is Natural range 0 .. Sensor_Id'Pos (Sensor_Id'Last) + 1;
   type Port_List  is array (1 .. Port_Count'Last) of Sensor_Id;

   type Request is record
      Output       : Byte_Array (1 .. Longest_Header + Longest_Data);
      Output_Last  : Natural := 0;
      Input_Length : Data_Length := 0;
      Read_Address : Byte := 0;
   end record;

   protected Buses with Interrupt_Priority => Priorities.I2C_Interrupt is
      procedure Enable (Port : Sensor_Id; Mode : IO_Modes);
      procedure Disable (Port : Sensor_Id);
      function Enabled (Port : Sensor_Id) return Boolean;
      function Busy (Port : Sensor_Id) return Boolean;
      procedure Start (Port : Sensor_Id; Wanted : Request; Result : out Integer);
      function State_Of (Port : Sensor_Id) return Bus;
   private
      procedure Handle_Tick with Attach_Handler => Ada.Interrupts.Names.TC1;
      Table   : Bus_Table;
      Open    : Flag_Table := (others => False);
      Used    : Flag_Table := (others => False);
      Ports   : Port_List  := (others => Sensor_Id'First);
      Last    : Port_Count := 0;
      --  Ports (1 .. Last) are those that were ever open, as Used says.
      Running : Boolean := False;
   end Buses;

   protected body Buses is

      procedure Enable (Port : Sensor_Id; Mode : IO_Modes) is
      begin
         Table (Port).State := Idle;
         Table (Port).LEGO_Mode := (Mode and LEGO_Mode) /= 0;
         Open (Port) := True;
         if not Used (Port) then
            Used (Port) := True;
            Last := Last + 1;
            Ports (Last) := Port;
         end if;
         Take_Lines (Port);
      end Enable;

      procedure Disable (Port : Sensor_Id) is
      begin
         if Table (Port).State /= Idle then
            Table (Port).State := Idle;
            Table (Port).Failed := True;
            Set_True (Ended (Port));
         end if;
         Open (Port) := False;
      end Disable;

      function Enabled (Port : Sensor_Id) return Boolean is (Open (Port));

      function Busy (Port : Sensor_Id) return Boolean is (Table (Port).State /= Idle);

      procedure Start (Port : Sensor_Id; Wanted : Request; Result : out Integer) is
      begin
         if not Open (Port) then
            Result := Not_Enabled;
         elsif Busy (Port) then
            Result := Port_Busy;
         elsif not Free (Port) then
            Result := Port_Fault;
         else
            Result := 0;
            Set_False (Ended (Port));
            Table (Port).Output := Wanted.Output;
            Table (Port).Output_Last := Wanted.Output_Last;
            Table (Port).Input_Length := Wanted.Input_Length;
            Table (Port).Read_Address := Wanted.Read_Address;
            Begin_Transfer (Table (Port));
            if not Running then
               Running := True;
               TC1.TC_CCR := TC.Enable or Trigger;
            end if;
         end if;
      end Start;

      function State_Of (Port : Sensor_Id) return Bus is (Table (Port));

      procedure Handle_Tick is
         Ignored : constant Word := TC1.TC_SR;
         Left    : Boolean := False;
         pragma Unreferenced (Ignored);
      begin
         for Port of Ports (1 .. Last) loop
            pragma Annotate (Ravenbrick, Iterations, 4, "ports with sensors", "ultrasonic");
            if Table (Port).State /= Idle then
               Tick (Table (Port), Port);
               if Table (Port).State = Idle then
                  Set_True (Ended (Port));
               else
                  Left := True;
               end if;
            end if;
         end loop;
         if not Left then
            TC1.TC_CCR := TC.Disable;
            Running := False;
         end if;
      end Handle_Tick;

   end Buses;

   procedure Initialize is
   begin
      Disable_All_Ports;
   end Initialize;

   procedure Configure_I2C_Port (Port : Sensor_Id; Mode : IO_Modes) is
   begin
      Buses.Enable (Port, Mode);
   end Configure_I2C_Port;

   function Enabled (Port : Sensor_Id) return Boolean is (Buses.Enabled (Port));

   procedure Disable (Port : Sensor_Id) is
   begin
      Buses.Disable (Port);
      Sensor_Ports.Reset (Port);
   end Disable;

   procedure Disable_All_Ports is
   begin
      for Port in Sensor_Id loop
         Disable (Port);
      end loop;
   end Disable_All_Ports;

   function Busy (Port : Sensor_Id) return Boolean is (Buses.Busy (Port));

   procedure Append (To : in out Request; Value : Unsigned_32) is
   begin
      To.Output_Last := To.Output_Last + 1;
      To.Output (To.Output_Last) := Byte (Value and 16#FF#);
   end Append;

   procedure Append_Header
     (To : in out Request; Device, Register : Unsigned_32; Register_Bytes : Unsigned_16) is
   begin
      Append (To, Device);
      for Place in reverse 0 .. Integer (Register_Bytes) - 1 loop
         Append (To, Shift_Right (Register, 8 * Place));
      end loop;
   end Append_Header;

   procedure Append_Data (To : in out Request; Buffer : System.Address; Length : Positive) is
      Data : Byte_Array (1 .. Length) with Import, Address => Buffer;
   begin
      for Value of Data loop
         Append (To, Unsigned_32 (Value));
      end loop;
   end Append_Data;

   procedure Start_Transaction
     (Port                   : Sensor_Id;
      Device_Address         : Unsigned_32;
      Register_Address       : Unsigned_32;
      Register_Address_Bytes : Unsigned_16;
      Write_Buffer           : System.Address;
      Bytes_To_Transfer      : Positive;
      Operation              : Transfer_Type;
      Result                 : out Integer)
   is
      Wanted : Request;
   begin
      if Bytes_To_Transfer > Maximum_Length
        or else Register_Address_Bytes > Longest_Header - 1
      then
         Result := Too_Long;
         return;
      end if;
      if Operation = Write or else Register_Address_Bytes > 0 then
         Append_Header (Wanted, Device_Address, Register_Address, Register_Address_Bytes);
      end if;
      if Operation = Write then
         Append_Data (Wanted, Write_Buffer, Bytes_To_Transfer);
      else
         Wanted.Input_Length := Bytes_To_Transfer;
         Wanted.Read_Address := Byte (Device_Address and 16#FF#) or Read_Direction;
      end if;
      Buses.Start (Port, Wanted, Result);
   end Start_Transaction;

   procedure Await_End (Port : Sensor_Id) is
   begin
      Suspend_Until_True (Ended (Port));
   end Await_End;

   procedure Complete_Transaction
     (Port            : Sensor_Id;
      Incoming_Buffer : System.Address;
      Bytes_To_Read   : Positive;
      Result          : out Integer)
   is
      Final : constant Bus := Buses.State_Of (Port);
   begin
      if not Buses.Enabled (Port) then
         Result := Not_Enabled;
      elsif Final.State /= Idle then
         Result := Port_Busy;
      elsif Final.Failed then
         Result := Port_Fault;
      elsif Bytes_To_Read > Maximum_Length then
         Result := Too_Long;
      elsif Final.Input_Length = 0 then
         Result := Bytes_To_Read;
      else
         Result := Natural'Min (Bytes_To_Read, Final.Input_Count);
         declare
            Data : Byte_Array (1 .. Result) with Import, Address => Incoming_Buffer;
         begin
            Data := Final.Input (1 .. Result);
         end;
      end if;
   end Complete_Transaction;

begin
   PMC.PMC.PMC_PCER := Bit (TC1_Id);
   TC1.TC_CMR := Repeating;
   TC1.TC_RC := Counts_Per_Tick;
   TC1.TC_IER := Compared;
   Initialize;
end NXT.I2C_Ports;
