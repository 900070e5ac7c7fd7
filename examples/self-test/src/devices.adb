--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;      use Ada.Real_Time;
with Chip;
with Link_Timing;
with NXT;                use NXT;
with NXT.Audio;
with NXT.AVR;
with NXT.Battery;
with NXT.Display;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Registers;      use NXT.Registers;
with NXT.Registers.ADC;
with NXT.Registers.PMC;
with NXT.Touch_Sensors;
with NXT.USB;
with Results;

package body Devices is

   use type Word;

   Names : constant array (Motor_Id) of Character := "ABC";

   procedure Pause (Milliseconds_Long : Positive) is
   begin
      delay until Clock + Milliseconds (Milliseconds_Long);
   end Pause;

   procedure Measure_Converter is
      Channel       : constant ADC.Channel := ADC.Digital_1 (Sensor_3);
      Counter_Range : constant Word := 2 ** 16;
      Start         : Word;
   begin
      PMC.PMC.PMC_PCER := Bit (ADC_Id);
      ADC.ADC.ADC_MR := ADC.Ten_Bits;
      ADC.ADC.ADC_CHER := Bit (Channel);
      Link_Timing.Await_Quiet;
      Start := Chip.Stopwatch.Value;
      ADC.ADC.ADC_CR := ADC.Start;
      while not Has (Chip.ADC_Status, Bit (Channel)) loop
         null;
      end loop;
      Results.Put
        ("converter.conversion",
         2 * Integer ((Chip.Stopwatch.Value - Start) mod Counter_Range), "cycles");
      ADC.ADC.ADC_CHDR := Bit (Channel);
   end Measure_Converter;

   procedure Measure_Supply is
      Ports : constant array (Sensor_Id) of Character := "1234";
   begin
      Results.Put ("battery.voltage", Integer (NXT.Battery.Voltage), "mV");
      Results.Put ("battery.word", Integer (NXT.AVR.Raw_Battery), "counts");
      for Port in Sensor_Id loop
         Results.Put ("port." & Ports (Port), Integer (NXT.AVR.Reading (Port)), "counts");
      end loop;
      Measure_Converter;
   end Measure_Supply;

   --  Degrees that a motor turns in half a second
   function Turned (Motor : Motor_Id; Duty : PWM_Value) return Integer is
      Before : constant Integer := NXT.Motor_Encoders.Encoder_Count (Motor);
      Degrees : Integer;
   begin
      NXT.Motor_Controls.Drive (Motor, Duty);
      Pause (500);
      Degrees := NXT.Motor_Encoders.Encoder_Count (Motor) - Before;
      NXT.Motor_Controls.Brake (Motor);
      Pause (300);
      return Degrees;
   end Turned;

   procedure Measure_Motors is
      Duty       : constant PWM_Value := 70;
      Surely     : constant := 20;
      Name       : String := "motor.A";
      Forwards   : Integer;
      Backwards  : Integer;
   begin
      for Motor in Motor_Id loop
         Name (Name'Last) := Names (Motor);
         Forwards := Turned (Motor, Duty);
         if abs Forwards < Surely then
            Results.Skip (Name, "no motor, or one that cannot turn");
         else
            Backwards := Turned (Motor, -Duty);
            Results.Put (Name & ".forwards", Forwards, "degrees");
            Results.Put (Name & ".backwards", Backwards, "degrees");
         end if;
      end loop;
   end Measure_Motors;

   procedure Ask_For_Touch is
      Sensor   : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);
      Patience : constant Time := Clock + Seconds (10);
   begin
      NXT.Display.Put_At (0, 5, "Press sensor 1");
      while not NXT.Touch_Sensors.Pressed (Sensor) and then Clock < Patience loop
         Pause (10);
      end loop;
      if NXT.Touch_Sensors.Pressed (Sensor) then
         Results.Put ("touch.pressed", Integer (NXT.AVR.Reading (Sensor_1)), "counts");
      else
         Results.Skip ("touch", "nothing was pressed in port 1");
      end if;
      NXT.Display.Put_At (0, 5, "              ");
   end Ask_For_Touch;

   procedure Measure_Sound is
      Start : constant Time := Clock;
      Limit : constant Time := Start + Seconds (2);
   begin
      NXT.Audio.Play_Tone (440, 500, 50);
      while NXT.Audio.Time_Remaining > 0 and then Clock < Limit loop
         delay until Clock + Microseconds (200);
      end loop;
      Results.Put ("sound.half_second", (Clock - Start) * 1_000 / Milliseconds (1), "us");
   end Measure_Sound;

   --  The slow clock runs beside: a value read twice alike is a good one.
   function Slow_Count return Word is
      First, Second : Word;
   begin
      loop
         First := Chip.RTT_Value;
         Second := Chip.RTT_Value;
         exit when First = Second;
      end loop;
      return First;
   end Slow_Count;

   procedure Measure_Slow_Clock is
      Divider : constant Word := 8;
      Counts  : constant Word := 4_096;
      First   : Word;
      Start   : Time;
      Span    : Time_Span;
   begin
      Chip.RTT_Mode := Chip.RTT_Restart or Divider;
      Pause (10);
      First := Slow_Count;
      while Slow_Count = First loop
         null;
      end loop;
      Start := Clock;
      while Slow_Count - First <= Counts loop
         null;
      end loop;
      Span := Clock - Start;
      Results.Put
        ("clock.slow", Integer (Divider * Counts) * 10_000 / (Span * 10 / Milliseconds (1)), "Hz");
   end Measure_Slow_Clock;

   procedure Measure_Frames is
      Frames  : constant := 1_000;
      Numbers : constant Word := 2 ** 11;
      Patience : constant Time := Clock + Seconds (5);
      First   : Word;
      Passed  : Word := 0;
      Start   : Time;

      procedure Await_Frame is
         Before : constant Word := First;
      begin
         while First = Before and then Clock < Patience loop
            First := Chip.UDP_Frame mod Numbers;
         end loop;
      end Await_Frame;

   begin
      if not NXT.USB.Configured then
         Results.Skip ("clock.usb_second", "no USB host has configured the brick");
         return;
      end if;
      First := Chip.UDP_Frame mod Numbers;
      Await_Frame;
      Start := Clock;
      while Passed < Frames and then Clock < Patience loop
         Await_Frame;
         Passed := Passed + 1;
      end loop;
      Results.Put ("clock.usb_second", (Clock - Start) * 1_000 / Milliseconds (1), "us");
   end Measure_Frames;

   procedure Measure_Clocks is
   begin
      Measure_Slow_Clock;
      Measure_Frames;
   end Measure_Clocks;

end Devices;
