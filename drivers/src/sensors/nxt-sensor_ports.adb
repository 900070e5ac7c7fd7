--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Converter;
with NXT.Registers.ADC;
with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;

package body NXT.Sensor_Ports is

   procedure Set_Pin_Mode (Port : Sensor_Id; Pin : Pin_Id; Mode : Modes) is
      Mask    : constant Word := Bit (Line_Of (Port, Pin));
      Channel : constant Registers.ADC.Channel := Registers.ADC.Digital_1 (Port);
   begin
      PIOA.PIO_PUDR := Mask;
      if Pin = Digital_1 and then Mode /= ADC then
         Converter.Release_Channel (Channel);
      end if;
      case Mode is
         when Off | Input =>
            PIOA.PIO_ODR := Mask;
         when Output =>
            PIOA.PIO_MDDR := Mask;
            PIOA.PIO_OER := Mask;
         when ADC =>
            PIOA.PIO_ODR := Mask;
            Converter.Use_Channel (Channel);
      end case;
      PIOA.PIO_PER := Mask;
   end Set_Pin_Mode;

   procedure Convert (Port : Sensor_Id; Before : out ADC_Value) is
   begin
      Before := Converter.Count (Registers.ADC.Digital_1 (Port));
      Converter.Start;
   end Convert;

   function Current_State (Port : Sensor_Id; Pin : Pin_Id) return Pin_States is
     (if Has (PIOA.PIO_PDSR, Bit (Line_Of (Port, Pin))) then High else Low);

   procedure Set_Pin_State (Port : Sensor_Id; Pin : Pin_Id; Value : Pin_States) is
      Mask : constant Word := Bit (Line_Of (Port, Pin));
   begin
      case Value is
         when Low  => PIOA.PIO_CODR := Mask;
         when High => PIOA.PIO_SODR := Mask;
      end case;
   end Set_Pin_State;

   procedure Set_Input_Power (Port : Sensor_Id; Kind : Sensor_Power) is
   begin
      NXT.AVR.Set_Input_Power (Port, Kind);
   end Set_Input_Power;

   procedure Reset (Port : Sensor_Id) is
   begin
      for Pin in Pin_Id loop
         Set_Pin_Mode (Port, Pin, Input);
         Set_Pin_State (Port, Pin, Low);
      end loop;
      Set_Input_Power (Port, Standard_Power);
   end Reset;

   procedure Reset_All_Ports is
   begin
      for Port in Sensor_Id loop
         Reset (Port);
      end loop;
   end Reset_All_Ports;

begin
   PMC.PMC.PMC_PCER := Bit (PIOA_Id);
   Reset_All_Ports;
end NXT.Sensor_Ports;
