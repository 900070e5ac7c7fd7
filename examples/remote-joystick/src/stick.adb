--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;      use Ada.Real_Time;
with Joystick_Commands;  use Joystick_Commands;
with NXT.AVR;
with NXT.Bluetooth;      use NXT.Bluetooth;
with NXT.Bytes;
with NXT.Frames;
with NXT.Motor_Encoders;
with NXT.Shared_State;
with NXT.Touch_Sensors;

package body Stick is

   package Shared is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   use NXT;
   use type NXT.Bytes.Byte;

   First_Release  : constant Time := NXT.AVR.First_Release;
   Period         : constant Time_Span := Milliseconds (Period_Ms);
   Looking_Period : constant := 5;
   --  Seconds that a search takes.

   function Latest return Status is (Shared.Get);

   Sensor  : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);
   Touched : Boolean := True;
   Now     : Status;

   procedure Show (State : Contact) is
   begin
      Now.Contact := State;
      Shared.Set (Now);
   end Show;

   procedure Read_Stick is
      Touched_Now : constant Boolean := NXT.Touch_Sensors.Pressed (Sensor);
      Count       : constant Integer := NXT.Motor_Encoders.Encoder_Count (Motor_A);
   begin
      if Touched_Now and then not Touched then
         Now.Running := not Now.Running;
      end if;
      Touched := Touched_Now;
      Now.Angle := Integer'Max (-90, Integer'Min (90, Count));
   end Read_Stick;

   procedure Tell is
      Line : Bytes.Byte_Array (1 .. Content'Length + NXT.Frames.Overhead);
      Last : Natural;
   begin
      NXT.Frames.Encode (To_Content ((Now.Running, Steering (Now.Angle))), Line, Last);
      if Room >= Last then
         Send (Line (1 .. Last));
      end if;
   end Tell;

   function Is_Vehicle (Item : Device) return Boolean is
     (for all Index in Vehicle_Name'Range =>
         Item.Name (Index - Vehicle_Name'First) = Character'Pos (Vehicle_Name (Index)));

   procedure Look_For_Vehicle (Address : out BT_Address; Success : out Boolean) is
      Found : Device_List (0 .. 3);
      Count : Natural;
   begin
      Address := (others => 0);
      Success := False;
      Find_Discoverable_Devices (Looking_Period, Found, Count);
      for Item of Found (0 .. Count - 1) loop
         pragma Annotate (Ravenbrick, Iterations, 16, "four devices; the letters of a name");
         if Is_Vehicle (Item) then
            Address := Item.Addr;
            Success := True;
         end if;
      end loop;
   end Look_For_Vehicle;

   --  Its waits are none of the task's own.
   procedure Start with No_Inline;

   procedure Start is
   begin
      loop
         pragma Annotate (Ravenbrick, Iterations, 600, "ten minutes, before the first job");
         Initialize;
         exit when Available;
         delay until Clock + Seconds (1);
      end loop;
   end Start;

   --  Until the vehicle is there. Its waits are none of the task's own.
   procedure Search with No_Inline;

   procedure Search is
      Address : BT_Address;
      Success : Boolean;
   begin
      loop
         pragma Annotate (Ravenbrick, Iterations, 600, "an hour; no job with a deadline");
         delay until Clock + Period;
         Show (Looking);
         Look_For_Vehicle (Address, Success);
         if Success then
            Show (Calling);
            Connect (Address, To_Pin (Vehicle_Pin), Success);
         end if;
         exit when Success;
      end loop;
   end Search;

   --  The vehicle stands when a connection begins.
   task body Radio_Task is
      Next_Release : Time;
   begin
      Start;
      loop
         Search;
         Now.Running := False;
         Next_Release := First_Release + Period * ((Clock - First_Release) / Period + 1);
         loop
            Next_Release := Next_Release + Period;
            delay until Next_Release;
            Poll;
            exit when State /= Connected;
            Read_Stick;
            Tell;
            Show (Stick.Connected);
         end loop;
      end loop;
   end Radio_Task;

end Stick;
