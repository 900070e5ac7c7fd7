--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The link to the co-processor that drives the motors, reads sensors and buttons and holds the
--  power. A task of this package exchanges one frame each Period, outputs and inputs in turn; every
--  program that uses a motor or a sensor needs this package in its closure. The task also stops the
--  motors and switches the brick off when the power button is held for 3 s, see
--  NXT.Forced_Power_Off, unless something of the same or a higher priority never lets it run.

with Ada.Real_Time;
with Interfaces;
with NXT.AVR_IO;
with NXT.Configuration;

package NXT.AVR with Elaborate_Body is

   Period : constant Ada.Real_Time.Time_Span;
   --  One frame per Period: outputs reach the co-processor, and inputs come back, every second one.

   function First_Release return Ada.Real_Time.Time;
   --  First release of the link's task. Releases at an even number of periods after it ask for
   --  inputs, at an odd number send outputs; periodic tasks that count from it keep that phase.

   --  Outputs: take effect with the next frame sent

   procedure Set_Power (Motor : Motor_Id; Power : PWM_Value; Brake : Boolean);
   --  Drive Motor with a duty cycle. At Power 0 it brakes or, without Brake, coasts; otherwise it
   --  is driven with slow decay, where the mean voltage is proportional to Power.

   procedure Set_Output (Motor : Motor_Id; Duty : PWM_Value; Short_When_Off : Boolean);
   --  As Set_Power, with the decay chosen: see NXT.AVR_IO.Outputs.Brakes.

   procedure Set_Input_Power (Port : Sensor_Id; Power_Type : Sensor_Power);

   procedure Power_Down;
   --  Stop the motors and switch the brick off, within a few periods. There is no way back.

   procedure Enter_Boot_Monitor;
   --  See NXT.Power.

   --  Inputs: of the last frame received without error

   function Data_Available return Boolean;
   --  Whether a frame has arrived. Before, inputs are those of an idle brick without a battery.

   procedure Await_Data_Available;
   --  Delay the calling task until Data_Available.

   function Inputs return AVR_IO.Inputs;
   --  All inputs of one frame.

   function Button return Button_Id;
   --  The button held down; a combination of buttons reads as one of them.

   function Reading (Port : Sensor_Id) return ADC_Value;
   --  Recommended.

   function Raw_Input (Port : Sensor_Id) return Interfaces.Unsigned_16;

   function Raw_Battery return Interfaces.Unsigned_16;
   --  As received, see NXT.AVR_IO.Inputs.Battery_Word; NXT.Battery gives millivolts.

   --  Health of the link

   type Error_Count is range 0 .. 2 ** 31 - 1;

   function Link_Errors return Error_Count;
   --  Transfers that failed, did not end in time or had a wrong sum, since the start.

   function Link_Losses return Error_Count;
   --  How often the link was lost: a transfer did not end, or four in a row failed in one
   --  direction. The bus is then reset and the co-processor greeted, which takes 40 ms, until it
   --  answers. The first outputs after that brake every motor that was not commanded since the
   --  loss; inputs stay those of the last good frame. A co-processor that hears nothing goes on
   --  with what it was told last.

private

   Period : constant Ada.Real_Time.Time_Span :=
     Ada.Real_Time.Milliseconds (Configuration.Link_Period_Ms);

end NXT.AVR;
