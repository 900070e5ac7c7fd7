--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Forced_Power_Off;
with NXT.Last_Chance;
pragma Unreferenced (NXT.Last_Chance);
with NXT.Low_Battery.Observe;
with NXT.Priorities;
with NXT.TWI;
with Ravenbrick.Failures;
with Ravenbrick.Supervision;

package body NXT.AVR is

   use Ada.Real_Time;
   use Ravenbrick;
   use type AVR_IO.Power_Command;
   use type AVR_IO.Verdict;
   use type TWI.Transfer_Status;

   Stack_Size : constant := 1_024;

   --  Periods in which the co-processor is left alone before and after the greeting, 20 ms
   Quiet_Periods : constant := 20 / Configuration.Link_Period_Ms;

   --  Consecutive failures in one direction after which the link is lost
   Tolerated_Failures : constant := 3;

   --  A loss for longer ends the program: the motors get no other command when the link is back.
   Tolerated_Loss_Ms : constant := 250;

   Link_Lost : constant String := "link to motors lost" & ASCII.NUL;

   Start : constant Time := Clock + Milliseconds (2);

   function First_Release return Time is (Start);

   --  Of the outputs, or of the inputs
   function Frames_Per (Time_Ms : Natural) return Natural is
     (Time_Ms / (2 * Configuration.Link_Period_Ms)) with Inline;

   protected Shared with Priority => Priorities.Shared_Data is
      procedure Set_Motor (Motor : Motor_Id; Duty : PWM_Value; Brake : Boolean);
      procedure Set_Supply (Port : Sensor_Id; Supply : Sensor_Power);
      procedure Shut_Down (Command : AVR_IO.Power_Command);
      procedure Brake_Motors;
      procedure Take_Outputs (Values : out AVR_IO.Outputs);
      procedure Put_Inputs (Values : AVR_IO.Inputs);
      function Inputs return AVR_IO.Inputs;
      function Received return Boolean;
   private
      Commands  : AVR_IO.Outputs;
      Readings  : AVR_IO.Inputs;
      Available : Boolean := False;
      Silence   : Natural := 0;
   end Shared;
   --  Silence: frames sent since the latest command of a motor

   Errors : Error_Count := 0 with Atomic;
   Losses : Error_Count := 0 with Atomic;
   --  Both written by the link's task only.

   task Coprocessor_Task with
     Priority     => Configuration.Link_Priority,
     Storage_Size => Stack_Size;

   protected body Shared is

      procedure Set_Motor (Motor : Motor_Id; Duty : PWM_Value; Brake : Boolean) is
      begin
         Silence := 0;
         if Commands.Power = AVR_IO.Stay_On then
            Commands.Duties (Motor) := Duty;
            Commands.Brakes (Motor) := Brake;
         end if;
      end Set_Motor;

      procedure Set_Supply (Port : Sensor_Id; Supply : Sensor_Power) is
      begin
         Commands.Sensor_Supply (Port) := Supply;
      end Set_Supply;

      procedure Shut_Down (Command : AVR_IO.Power_Command) is
      begin
         Commands := AVR_IO.All_Stopped;
         Commands.Power := Command;
      end Shut_Down;

      procedure Brake_Motors is
      begin
         Commands.Duties := AVR_IO.All_Stopped.Duties;
         Commands.Brakes := AVR_IO.All_Stopped.Brakes;
      end Brake_Motors;

      procedure Take_Outputs (Values : out AVR_IO.Outputs) is
      begin
         if Silence < Frames_Per (Supervision.Command_Timeout_Ms) then
            Silence := Silence + 1;
         elsif Silence > 0 then
            Brake_Motors;
         end if;
         Values := Commands;
      end Take_Outputs;

      procedure Put_Inputs (Values : AVR_IO.Inputs) is
      begin
         Readings := Values;
         Available := True;
      end Put_Inputs;

      function Inputs return AVR_IO.Inputs is (Readings);

      function Received return Boolean is (Available);

   end Shared;

   --  The link goes from Silent over Quiet and Greeting to Exchanging; repeated failure leads back.
   type Link_State is (Silent, Quiet, Greeting, Settling, Exchanging);

   --  What the transfer that may still run is for
   type Transfer_Purpose is (Nothing, Text, Commands, Readings);

   type Failure_Counts is array (Transfer_Purpose) of Natural;

   type Link is record
      State        : Link_State := Silent;
      Purpose      : Transfer_Purpose := Nothing;
      Quiet_Left   : Natural := 0;
      Failures     : Failure_Counts := (others => 0);
      Inputs_Next  : Boolean := True;
      Power_Button : Forced_Power_Off.Button_Watch;
      Low_Inputs   : Low_Battery.Input_Count := 0;
      Down_Periods : Natural := 0;
   end record;
   --  Low_Inputs: see NXT.Low_Battery.Observe. Down_Periods: since the latest good transfer of the
   --  link that was up.

   --  A good battery costs one comparison.
   procedure Judge_Battery (This : in out Link; Values : AVR_IO.Inputs) is
      Count : constant ADC_Value := Values.Battery_Count;
      Low   : constant ADC_Value :=
        (if Values.Rechargeable then Low_Battery.Low_Pack else Low_Battery.Low_Cells);
   begin
      if Count >= Low then
         This.Low_Inputs := 0;
      elsif Supervision.Enabled then
         Low_Battery.Observe (This.Low_Inputs, Values);
      end if;
   end Judge_Battery;

   procedure Accept_Readings (This : in out Link; Intact : out Boolean) is
      Frame     : AVR_IO.Input_Frame;
      Values    : AVR_IO.Inputs;
      Judgement : AVR_IO.Verdict;
      Held_Long : Boolean;
   begin
      TWI.Fetch (Frame);
      AVR_IO.Decode (Frame, Values, Judgement);
      if Judgement = AVR_IO.Valid then
         Shared.Put_Inputs (Values);
         Judge_Battery (This, Values);
         Forced_Power_Off.Observe (This.Power_Button, Values.Pressed, Due => Held_Long);
         if Held_Long then
            Shared.Shut_Down (AVR_IO.Switch_Off);
         end if;
      end if;
      Intact := Judgement /= AVR_IO.Corrupt;
   end Accept_Readings;

   --  Motors that nobody commands anew stay braked when the link is back.
   procedure Handle_Loss (This : in out Link) is
   begin
      This.State := Silent;
      Losses := Losses + 1;
      Shared.Brake_Motors;
   end Handle_Loss;

   procedure Judge_Loss (This : in out Link; Good : Boolean) is
   begin
      if Good and then This.Purpose in Commands | Readings then
         This.Down_Periods := 0;
      elsif Losses > 0 then
         This.Down_Periods := This.Down_Periods + 1;
         if Supervision.Enabled
           and then This.Down_Periods > Tolerated_Loss_Ms / Configuration.Link_Period_Ms
         then
            Failures.Stop (Link_Lost'Address);
         end if;
      end if;
   end Judge_Loss;

   --  Judge the transfer of the period before. One that has not ended by now never will, except the
   --  text: it lasts longer than a period if the co-processor holds the clock for 18 us after each
   --  byte, and may end while the link settles.
   procedure Complete_Transfer (This : in out Link) is
      Status : constant TWI.Transfer_Status := TWI.Status;
      Good   : Boolean := Status = TWI.Done;
   begin
      if This.Purpose = Text and then Status = TWI.Busy and then This.Quiet_Left > 1 then
         return;
      end if;
      if Good and then This.Purpose = Readings then
         Accept_Readings (This, Good);
      end if;
      if Good or else This.Purpose = Nothing then
         This.Failures (This.Purpose) := 0;
      else
         Errors := Errors + 1;
         This.Failures (This.Purpose) := This.Failures (This.Purpose) + 1;
      end if;
      if Status = TWI.Busy or else This.Failures (This.Purpose) > Tolerated_Failures then
         Handle_Loss (This);
      end if;
      Judge_Loss (This, Good);
      This.Purpose := Nothing;
   end Complete_Transfer;

   procedure Wait_Quietly (This : in out Link; Then_Enter : Link_State) is
   begin
      This.Quiet_Left := This.Quiet_Left - 1;
      if This.Quiet_Left = 0 then
         This.State := Then_Enter;
      end if;
   end Wait_Quietly;

   procedure Exchange (This : in out Link) is
      Outputs : AVR_IO.Outputs;
   begin
      if This.Inputs_Next then
         TWI.Start_Receive (AVR_IO.Address, AVR_IO.Input_Length);
         This.Purpose := Readings;
      else
         Shared.Take_Outputs (Outputs);
         TWI.Start_Send (AVR_IO.Address, AVR_IO.Encode (Outputs));
         This.Purpose := Commands;
      end if;
   end Exchange;

   procedure Start_Transfer (This : in out Link) is
   begin
      case This.State is
         when Silent =>
            TWI.Reset;
            This.Failures := (others => 0);
            This.Quiet_Left := Quiet_Periods;
            This.State := Quiet;
         when Quiet =>
            Wait_Quietly (This, Then_Enter => Greeting);
         when Greeting =>
            TWI.Start_Send (AVR_IO.Address, AVR_IO.Greeting);
            This.Purpose := Text;
            This.Quiet_Left := Quiet_Periods;
            This.State := Settling;
         when Settling =>
            Wait_Quietly (This, Then_Enter => Exchanging);
         when Exchanging =>
            Exchange (This);
      end case;
      This.Inputs_Next := not This.Inputs_Next;
   end Start_Transfer;

   task body Coprocessor_Task is
      This         : Link;
      Next_Release : Time := Start;
   begin
      loop
         delay until Next_Release;
         Supervision.Check (Configuration.Link_Period_Ms);
         Complete_Transfer (This);
         Start_Transfer (This);
         Next_Release := Next_Release + Period;
      end loop;
   end Coprocessor_Task;

   procedure Set_Power (Motor : Motor_Id; Power : PWM_Value; Brake : Boolean) is
   begin
      Shared.Set_Motor (Motor, Power, Brake or else Power /= 0);
   end Set_Power;

   procedure Set_Output (Motor : Motor_Id; Duty : PWM_Value; Short_When_Off : Boolean) is
   begin
      Shared.Set_Motor (Motor, Duty, Short_When_Off);
   end Set_Output;

   procedure Set_Input_Power (Port : Sensor_Id; Power_Type : Sensor_Power) is
   begin
      Shared.Set_Supply (Port, Power_Type);
   end Set_Input_Power;

   procedure Power_Down is
   begin
      Shared.Shut_Down (AVR_IO.Switch_Off);
   end Power_Down;

   procedure Enter_Boot_Monitor is
   begin
      Shared.Shut_Down (AVR_IO.Boot_Monitor);
   end Enter_Boot_Monitor;

   function Data_Available return Boolean is (Shared.Received);

   procedure Await_Data_Available is
      Next_Check : Time := Clock;
   begin
      while not Shared.Received loop
         Next_Check := Next_Check + Period;
         delay until Next_Check;
      end loop;
   end Await_Data_Available;

   function Inputs return AVR_IO.Inputs is (Shared.Inputs);

   function Button return Button_Id is (Shared.Inputs.Pressed);

   function Reading (Port : Sensor_Id) return ADC_Value is (Shared.Inputs.Sensors (Port));

   function Raw_Input (Port : Sensor_Id) return Interfaces.Unsigned_16 is
     (Interfaces.Unsigned_16 (Reading (Port)));

   function Raw_Battery return Interfaces.Unsigned_16 is (Shared.Inputs.Battery_Word);

   function Link_Errors return Error_Count is (Errors);

   function Link_Losses return Error_Count is (Losses);

end NXT.AVR;
