--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors as the protocol sees them.

with Interfaces;  use Interfaces;

private package NXT.Direct_Commands.Outputs is

   All_Ports : constant Byte := 16#FF#;

   function Is_Port (Port : Byte) return Boolean is (Port <= 2 or else Port = All_Ports);

   Setting_Length : constant := 9;
   --  Power, mode, regulation, turn ratio, run state, limit (4)

   procedure Set (Port : Byte; Setting : Byte_Array; Status : out Byte) with
     Pre => Is_Port (Port) and then Setting'Length >= Setting_Length;

   State_Length : constant := 22;

   function State (Port : Byte) return Byte_Array with
     Pre  => Port <= 2,
     Post => State'Result'Length = State_Length;
   --  Port, setting, and three counts of degrees: since the last command, the last relative
   --  reset, and the last absolute one

   procedure Reset_Position (Port : Byte; Relative : Boolean) with
     Pre => Is_Port (Port);

   procedure Stop_At_Limits;

end NXT.Direct_Commands.Outputs;
