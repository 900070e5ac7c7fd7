--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.Battery;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Priorities;
with Nxt_Position_Regulator;
with Nxt_Regulation_Design;   use Nxt_Regulation_Design;
with Nxt_Speed_Regulator;

package body NXT.Regulated_Motors is

   use Ada.Real_Time;
   use type NXT.AVR.Error_Count;
   use type NXT.Battery.Supply_Millivolts;

   Stack_Size : constant := 1_280;

   Period : constant Time_Span := Milliseconds (Sample_Time_Ms);

   type Command is record
      Kind  : Regulation := None;
      Fresh : Boolean := False;
      Speed : Regulated_Speed := 0;
      Angle : Degrees := 0;
   end record;
   --  Fresh: the task has not seen it. Speed: signed for Of_Speed, the limit for Of_Angle.

   type Measurement is record
      Angle   : Degrees := 0;
      Speed   : Degrees_Per_Second := 0;
      Resting : Boolean := False;
   end record;
   --  Resting: at the set angle.

   type Commands     is array (Motor_Id) of Command;
   type Measurements is array (Motor_Id) of Measurement;

   protected Shared with Priority => Priorities.Shared_Data is
      procedure Set (Motor : Motor_Id; To : Command);
      procedure Turn_By (Motor : Motor_Id; Angle, From : Degrees; Speed : Turning_Speed);
      procedure Stop (Motor : Motor_Id; Final : Rest);
      procedure Stop_All;
      procedure Take (Motor : Motor_Id; Now : out Command);
      procedure Drive (Motor : Motor_Id; Duty : PWM_Value);
      procedure Put (Motor : Motor_Id; Now : Measurement);
      function Wanted (Motor : Motor_Id) return Command;
      function Measured (Motor : Motor_Id) return Measurement;
   private
      Set_Points : Commands;
      Latest     : Measurements;
   end Shared;

   task Regulator_Task with
     Priority     => Priorities.Regulator_Task,
     Storage_Size => Stack_Size;

   protected body Shared is

      procedure Set (Motor : Motor_Id; To : Command) is
      begin
         Set_Points (Motor) := To;
         Latest (Motor).Resting := False;
      end Set;

      procedure Turn_By (Motor : Motor_Id; Angle, From : Degrees; Speed : Turning_Speed) is
         Start : constant Degrees :=
           (if Set_Points (Motor).Kind = Of_Angle then Set_Points (Motor).Angle else From);
      begin
         Set (Motor, (Of_Angle, True, Speed, Start + Angle));
      end Turn_By;

      procedure Stop (Motor : Motor_Id; Final : Rest) is
      begin
         Set (Motor, (Kind => None, others => <>));
         case Final is
            when Brake => Motor_Controls.Brake (Motor);
            when Float => Motor_Controls.Coast (Motor);
         end case;
      end Stop;

      procedure Stop_All is
      begin
         for Motor in Motor_Id loop
            Set (Motor, (Kind => None, others => <>));
         end loop;
      end Stop_All;

      procedure Take (Motor : Motor_Id; Now : out Command) is
      begin
         Now := Set_Points (Motor);
         Set_Points (Motor).Fresh := False;
      end Take;

      --  Nothing once the motor was stopped.
      procedure Drive (Motor : Motor_Id; Duty : PWM_Value) is
      begin
         if Set_Points (Motor).Kind /= None then
            Motor_Controls.Drive (Motor, Duty);
         end if;
      end Drive;

      procedure Put (Motor : Motor_Id; Now : Measurement) is
      begin
         Latest (Motor) := Now;
         if Set_Points (Motor).Fresh then
            Latest (Motor).Resting := False;
         end if;
      end Put;

      function Wanted (Motor : Motor_Id) return Command is (Set_Points (Motor));

      function Measured (Motor : Motor_Id) return Measurement is (Latest (Motor));

   end Shared;

   type Window_Index is mod Speed_Window;
   type Past_Readings is array (Window_Index) of Motor_Encoders.Reading;

   type Controller is record
      Speed   : Nxt_Speed_Regulator.Work_Area;
      Angle   : Nxt_Position_Regulator.Work_Area;
      Resting : Boolean := False;
   end record;

   type Controllers is array (Motor_Id) of Controller;

   type Regulator is record
      Past    : Past_Readings;
      Oldest  : Window_Index := 0;
      Motors  : Controllers;
      Losses  : NXT.AVR.Error_Count := 0;
      Battery : NXT.Battery.Supply_Millivolts := 0;
   end record;

   procedure Restart (This : in out Controller) is
   begin
      Nxt_Speed_Regulator.Initialize (This.Speed);
      Nxt_Position_Regulator.Initialize (This.Angle);
      This.Resting := False;
   end Restart;

   --  One count more or less within the window is the least speed that is seen.
   Least_Speed : constant Degrees_Per_Second := 1_000 / (Sample_Time_Ms * Speed_Window);

   --  From one angle to another, at most Limit: a program may set a count to any value.
   function Distance
     (From, To : Integer; Limit : Natural := Integer'Last) return Integer
   is
      Exact : constant Long_Long_Integer := Long_Long_Integer (To) - Long_Long_Integer (From);
      Most  : constant Long_Long_Integer := Long_Long_Integer (Limit);
   begin
      return Integer (Long_Long_Integer'Max (-Most, Long_Long_Integer'Min (Most, Exact)));
   end Distance;

   function Angle_To_Go (Now : Measurement; Wanted : Command) return Degrees is
     (Degrees (Distance (From => Integer (Now.Angle), To => Integer (Wanted.Angle))));

   --  Whether a motor is at its angle: begins close to it and slow, ends further off.
   function Is_At_Rest (This : Controller; Now : Measurement; Wanted : Command) return Boolean is
     (Wanted.Kind = Of_Angle
      and then
        (if This.Resting and then not Wanted.Fresh
         then abs Angle_To_Go (Now, Wanted) <= 2 * Tolerance
         else abs Angle_To_Go (Now, Wanted) <= Tolerance
              and then abs Now.Speed < 2 * Least_Speed));

   function Target_Speed
     (This : in out Controller; Now : Measurement; Wanted : Command) return Standard.Float
   is
      Limit  : constant Standard.Float := Standard.Float (Wanted.Speed);
      Output : Nxt_Position_Regulator.External_Outputs;
   begin
      if Wanted.Kind = Of_Speed then
         return Limit;
      end if;
      Nxt_Position_Regulator.Step
        (This.Angle, (Angle_To_Go => Standard.Float (Angle_To_Go (Now, Wanted))), Output);
      return Standard.Float'Max (-Limit, Standard.Float'Min (Limit, Output.Wanted_Speed));
   end Target_Speed;

   --  The duty cycle whose mean is a voltage.
   function To_Duty (Volts, Supply : Standard.Float) return PWM_Value is
     (PWM_Value
        (Standard.Float'Max (-100.0, Standard.Float'Min (100.0, 100.0 * Volts / Supply))));

   procedure Regulate
     (This   : in out Controller;
      Now    : in out Measurement;
      Wanted : Command;
      Supply : Standard.Float;
      Duty   : out PWM_Value)
   is
      Output : Nxt_Speed_Regulator.External_Outputs;
   begin
      This.Resting := Is_At_Rest (This, Now, Wanted);
      Nxt_Speed_Regulator.Step
        (This.Speed,
         (Input_Voltage => Target_Speed (This, Now, Wanted) / Speed_Per_Volt,
          Real_Voltage  => Standard.Float (Now.Speed) / Speed_Per_Volt),
         Output);
      Duty := To_Duty (Output.Correctedvoltage, Supply);
      Now.Resting := This.Resting;
   end Regulate;

   --  More than any motor turns within the window, and in micro-units not beyond an Integer
   Most_Counts : constant := 2_000;

   procedure Measure
     (This : in out Regulator; Now : Motor_Encoders.Reading; Values : out Measurements)
   is
      Past    : Motor_Encoders.Reading renames This.Past (This.Oldest);
      Elapsed : constant Integer := (Now.Instant - Past.Instant) / Microseconds (1);
      Counts  : Integer;
   begin
      for Motor in Motor_Id loop
         Counts := Distance (Past.Counts (Motor), Now.Counts (Motor), Most_Counts);
         Values (Motor) :=
           (Angle   => Degrees (Now.Counts (Motor)),
            Speed   => Degrees_Per_Second
              (Integer'Max (-2_000, Integer'Min (2_000, Counts * 1_000_000 / Elapsed))),
            Resting => False);
      end loop;
      Past := Now;
      This.Oldest := This.Oldest + 1;
   end Measure;

   --  A link that was lost has braked the motors; whoever commands them must know.
   procedure Check_Link (This : in out Regulator) is
   begin
      if NXT.AVR.Link_Losses /= This.Losses then
         This.Losses := NXT.AVR.Link_Losses;
         Shared.Stop_All;
      end if;
      This.Battery := NXT.Battery.Voltage;
   end Check_Link;

   procedure Run_Motors (This : in out Regulator) is
      Values : Measurements;
      Wanted : Command;
      Duty   : PWM_Value;
      Supply : constant Standard.Float := 0.001 * Standard.Float (This.Battery);
   begin
      Measure (This, Motor_Encoders.Current, Values);
      for Motor in Motor_Id loop
         Shared.Take (Motor, Wanted);
         if Wanted.Kind = None then
            Restart (This.Motors (Motor));
         elsif This.Battery > 0 then
            Nxt_Speed_Regulator.Parameters.Saturation := Supply;
            Regulate (This.Motors (Motor), Values (Motor), Wanted, Supply, Duty);
            Shared.Drive (Motor, Duty);
         end if;
         Shared.Put (Motor, Values (Motor));
      end loop;
   end Run_Motors;

   task body Regulator_Task is
      This : Regulator;
      Next : Time := NXT.AVR.First_Release + Period;
      First : constant Motor_Encoders.Reading := Motor_Encoders.Current;
   begin
      This.Past := (others => First);
      loop
         delay until Next;
         Check_Link (This);
         Run_Motors (This);
         Next := Next + Period;
      end loop;
   end Regulator_Task;

   procedure Run (Motor : Motor_Id; Speed : Regulated_Speed) is
   begin
      Shared.Set (Motor, (Of_Speed, True, Speed, 0));
   end Run;

   procedure Turn_To (Motor : Motor_Id; Angle : Degrees; Speed : Turning_Speed := 500) is
   begin
      Shared.Set (Motor, (Of_Angle, True, Speed, Angle));
   end Turn_To;

   procedure Turn_By (Motor : Motor_Id; Angle : Degrees; Speed : Turning_Speed := 500) is
   begin
      Shared.Turn_By (Motor, Angle, Regulated_Motors.Angle (Motor), Speed);
   end Turn_By;

   procedure Stop (Motor : Motor_Id; Final : Rest := Brake) is
   begin
      Shared.Stop (Motor, Final);
   end Stop;

   function Regulation_Of (Motor : Motor_Id) return Regulation is (Shared.Wanted (Motor).Kind);

   function Angle (Motor : Motor_Id) return Degrees is
     (Degrees (Motor_Encoders.Encoder_Count (Motor)));

   function Speed (Motor : Motor_Id) return Degrees_Per_Second is (Shared.Measured (Motor).Speed);

   function Arrived (Motor : Motor_Id) return Boolean is (Shared.Measured (Motor).Resting);

   procedure Await_Arrival
     (Motor : Motor_Id; Limit : Ada.Real_Time.Time_Span; Success : out Boolean)
   is
      Next_Check : Time := Clock;
      Last_Check : constant Time := Next_Check + Limit;
   begin
      loop
         Success := Arrived (Motor);
         exit when Success or else Next_Check >= Last_Check
           or else Regulation_Of (Motor) /= Of_Angle;
         Next_Check := Next_Check + Period;
         delay until Next_Check;
      end loop;
   end Await_Arrival;

end NXT.Regulated_Motors;
