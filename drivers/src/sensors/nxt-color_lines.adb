--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Ada.Synchronous_Task_Control;  use Ada.Synchronous_Task_Control;
with Interfaces;                    use Interfaces;
with NXT.Converter;
with NXT.Priorities;
with NXT.Registers.ADC;
with NXT.Registers.PIO;             use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.TC;              use NXT.Registers.TC;

package body NXT.Color_Lines is

   Steps_Per_Second : constant := 25_000;
   Counts_Per_Step  : constant := Clock_Hz / Steps_Per_Second;

   Bits_Per_Byte : constant := 8;

   type Activity is (Idle, Sending, Receiving, Sampling);

   type Lamp_Sums is array (Lamp) of Natural;

   type Line_State is record
      Now       : Activity := Idle;
      Step      : Natural := 0;
      Mode      : Byte := 0;
      Received  : Calibration := (others => 0);
      All_Lamps : Boolean := False;
      Current   : Lamp := Off;
      Sums      : Lamp_Sums := (others => 0);
      Lost      : Boolean := False;
   end record;
   --  Step: of the activity, from 0 on. Sums: of two counts each.

   function Clock_Of (Port : Sensor_Id) return Word is (Bit (Digital_0 (Port)));
   function Data_Of (Port : Sensor_Id) return Word is (Bit (Digital_1 (Port)));

   procedure Begin_Activity (This : in out Line_State; Wanted : Activity) is
   begin
      This.Now := Wanted;
      This.Step := 0;
   end Begin_Activity;

   --  Even steps raise the clock, then put the bit; odd ones let the clock fall.
   procedure Send_Step (This : in out Line_State; Port : Sensor_Id) is
      Is_One : constant Boolean := (Shift_Right (This.Mode, This.Step / 2) and 1) = 1;
   begin
      if This.Step mod 2 = 1 then
         PIOA.PIO_CODR := Clock_Of (Port);
      else
         PIOA.PIO_SODR := Clock_Of (Port);
         if Is_One then
            PIOA.PIO_SODR := Data_Of (Port);
         else
            PIOA.PIO_CODR := Data_Of (Port);
         end if;
      end if;
      This.Step := This.Step + 1;
      if This.Step = 2 * Bits_Per_Byte then
         Begin_Activity (This, Receiving);
      end if;
   end Send_Step;

   --  Even steps raise the clock, odd ones take the bit and let the clock fall.
   procedure Receive_Step (This : in out Line_State; Port : Sensor_Id) is
      Place : constant Positive := 1 + This.Step / (2 * Bits_Per_Byte);
   begin
      if This.Step = 0 then
         PIOA.PIO_ODR := Data_Of (Port);
      end if;
      if This.Step mod 2 = 0 then
         PIOA.PIO_SODR := Clock_Of (Port);
      else
         This.Received (Place) := Shift_Right (This.Received (Place), 1)
           or (if Has (PIOA.PIO_PDSR, Data_Of (Port)) then 16#80# else 0);
         PIOA.PIO_CODR := Clock_Of (Port);
      end if;
      This.Step := This.Step + 1;
      if This.Step = 2 * Bits_Per_Byte * Calibration'Length then
         This.Now := Idle;
      end if;
   end Receive_Step;

   procedure Switch_To_Next_Lamp (This : in out Line_State; Port : Sensor_Id) is
   begin
      case This.Current is
         when Off | Green => PIOA.PIO_SODR := Clock_Of (Port);
         when Red | Blue  => PIOA.PIO_CODR := Clock_Of (Port);
      end case;
      This.Current := (if This.Current = Blue then Off else Lamp'Succ (This.Current));
   end Switch_To_Next_Lamp;

   --  With each lamp: wait for the light, two conversions one after the other, the next lamp. In
   --  the end the clock is let go; the sensor must hold it low.
   procedure Sample_Step (This : in out Line_State; Port : Sensor_Id) is

      procedure Add is
      begin
         This.Sums (This.Current) :=
           This.Sums (This.Current) + Natural (Converter.Count (Registers.ADC.Digital_1 (Port)));
      end Add;

   begin
      case This.Step is
         when 0 =>
            null;
         when 1 =>
            Converter.Start;
         when 2 =>
            Add;
            Converter.Start;
         when 3 =>
            Add;
            if This.All_Lamps then
               Switch_To_Next_Lamp (This, Port);
            end if;
            if This.Current = Off then
               PIOA.PIO_ODR := Clock_Of (Port);
            else
               This.Step := 0;
               return;
            end if;
         when others =>
            This.Lost := This.Lost or else Has (PIOA.PIO_PDSR, Clock_Of (Port));
            This.Now := Idle;
      end case;
      This.Step := This.Step + 1;
   end Sample_Step;

   Ended : array (Sensor_Id) of Suspension_Object;

   type Line_States is array (Sensor_Id) of Line_State;

   protected Lines with Interrupt_Priority => Priorities.Color_Interrupt is
      procedure Exchange (Port : Sensor_Id; Mode : Mode_Code);
      procedure Sample (Port : Sensor_Id; All_Lamps : Boolean);
      function State_Of (Port : Sensor_Id) return Line_State;
   private
      procedure Begin_Steps;
      procedure Handle_Step with Attach_Handler => Ada.Interrupts.Names.TC2;
      Table   : Line_States;
      Running : Boolean := False;
   end Lines;

   protected body Lines is

      procedure Begin_Steps is
      begin
         if not Running then
            Running := True;
            TC2.TC_CCR := TC.Enable or Trigger;
         end if;
      end Begin_Steps;

      procedure Exchange (Port : Sensor_Id; Mode : Mode_Code) is
      begin
         Table (Port).Mode := Mode;
         Begin_Activity (Table (Port), Sending);
         Begin_Steps;
      end Exchange;

      procedure Sample (Port : Sensor_Id; All_Lamps : Boolean) is
      begin
         Table (Port).All_Lamps := All_Lamps;
         Table (Port).Current := Off;
         Table (Port).Sums := (others => 0);
         Table (Port).Lost := Has (PIOA.PIO_PDSR, Clock_Of (Port));
         Begin_Activity (Table (Port), Sampling);
         if All_Lamps then
            PIOA.PIO_CODR := Clock_Of (Port);
            PIOA.PIO_OER := Clock_Of (Port);
         end if;
         Begin_Steps;
      end Sample;

      function State_Of (Port : Sensor_Id) return Line_State is (Table (Port));

      procedure Handle_Step is
         Ignored : constant Word := TC2.TC_SR;
         Left    : Boolean := False;
         pragma Unreferenced (Ignored);
      begin
         for Port in Sensor_Id loop
            if Table (Port).Now /= Idle then
               case Table (Port).Now is
                  when Idle      => null;
                  when Sending   => Send_Step (Table (Port), Port);
                  when Receiving => Receive_Step (Table (Port), Port);
                  when Sampling  => Sample_Step (Table (Port), Port);
               end case;
               if Table (Port).Now = Idle then
                  Set_True (Ended (Port));
               else
                  Left := True;
               end if;
            end if;
         end loop;
         if not Left then
            TC2.TC_CCR := TC.Disable;
            Running := False;
         end if;
      end Handle_Step;

   end Lines;

   procedure Exchange
     (Port : Sensor_Id; Mode : Mode_Code; Received : out Calibration) is
   begin
      Set_False (Ended (Port));
      Lines.Exchange (Port, Mode);
      Suspend_Until_True (Ended (Port));
      Received := Lines.State_Of (Port).Received;
   end Exchange;

   procedure Sample (Port : Sensor_Id; All_Lamps : Boolean; Result : out Counts; Lost : out Boolean)
   is
   begin
      Set_False (Ended (Port));
      Lines.Sample (Port, All_Lamps);
      Suspend_Until_True (Ended (Port));
      declare
         Final : constant Line_State := Lines.State_Of (Port);
      begin
         for Lit in Lamp loop
            Result (Lit) := ADC_Value (Final.Sums (Lit) / 2);
         end loop;
         Lost := Final.Lost;
      end;
   end Sample;

begin
   PMC.PMC.PMC_PCER := Bit (TC2_Id) or Bit (PIOA_Id);
   TC2.TC_CMR := Repeating;
   TC2.TC_RC := Counts_Per_Step;
   TC2.TC_IER := Compared;
end NXT.Color_Lines;
