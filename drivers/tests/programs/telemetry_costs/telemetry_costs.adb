--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One operation of the telemetry every 100 ms, in the order of cost_table.py's list. A host
--  listens by the begin.

with Ada.Real_Time;  use Ada.Real_Time;
with Cost_Link;
with NXT.AVR;
with NXT.Telemetry;  use NXT.Telemetry;

procedure Telemetry_Costs is

   Operations : Integer := 6 with
     Volatile, Export, Convention => C, External_Name => "operations";

   Gain : Float := 0.0 with Volatile;
   One  : constant Value := Of_Real (1.0);

   procedure Perform (Operation : Positive) is
   begin
      case Operation is
         when 2      => Publish (1, (1 => One));
         when 3      => Publish (2, (1 .. 4 => One));
         when 4      => Publish (3, (1 .. 8 => One));
         when 5      => Gain := Current (Cost_Link.Gain);
         when others => null;
      end case;
   end Perform;

   Next : Time := NXT.AVR.First_Release + Milliseconds (2_501);
begin
   Cost_Link.Server.Require;
   for Operation in 1 .. Operations loop
      delay until Next;
      Perform (Operation);
      Next := Next + Milliseconds (100);
   end loop;
   delay until Time_Last;
end Telemetry_Costs;
