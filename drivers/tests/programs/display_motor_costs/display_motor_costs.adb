--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  As costs.adb, with drivers that do not fit beside those.

with Ada.Real_Time;         use Ada.Real_Time;
with NXT.AVR;
with NXT.Display.Drawing;   use NXT.Display, NXT.Display.Drawing;
with NXT.Parameters;
with NXT.Regulated_Motors;
with NXT.RS485;

procedure Display_Motor_Costs is

   use NXT;

   Operations : Integer := 8 with
     Volatile, Export, Convention => C, External_Name => "operations";

   Message  : constant NXT.RS485.Byte_Array (1 .. 16) := (others => 16#55#);
   Answer   : NXT.RS485.Byte_Array (1 .. 16);
   Accepted : Boolean with Volatile;
   Count    : Natural with Volatile;

   package Kept is new NXT.Parameters.Store (Integer, Id => 1, Format => 1);
   Kept_Value : Integer := 1;
   Result     : NXT.Parameters.Save_Result;

   procedure Perform (Operation : Positive) is
   begin
      case Operation is
         when 2      => Put_At_Noupdate (0, 3, "sixteen letters.");
         when 3      => Draw_Line ((0, 0), (99, 63));
         when 4      => NXT.Regulated_Motors.Turn_To (Motor_C, 10);
         when 5      => NXT.RS485.Send (Message, Accepted);
         when 6      => NXT.RS485.Receive (Answer, Count);
         when 7      => Kept.Load (Kept_Value, Accepted);
         when others => null;
      end case;
   end Perform;

   Next : Time := NXT.AVR.First_Release + Milliseconds (501);
begin
   NXT.RS485.Open (To => NXT.RS485.Loop_Back);
   Kept.Save (Kept_Value, Result);
   for Operation in 1 .. Operations loop
      delay until Next;
      Perform (Operation);
      Next := Next + Milliseconds (100);
   end loop;
   pragma Unreferenced (Answer, Result);
   delay until Time_Last;
end Display_Motor_Costs;
