--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sensors as the protocol sees them: their kinds, and readings of those with an analogue output.

with Interfaces;  use Interfaces;

private package NXT.Direct_Commands.Inputs is

   function Is_Port (Port : Byte) return Boolean is (Port <= 3);

   procedure Set (Port, Kind, Mode : Byte; Status : out Byte) with
     Pre => Is_Port (Port);
   --  Of which kind the sensor is, and how its reading is scaled.

   Values_Length : constant := 13;

   function Values (Port : Byte) return Byte_Array with
     Pre  => Is_Port (Port),
     Post => Values'Result'Length = Values_Length;
   --  Port, valid, calibrated, kind, mode, raw (2), normalised (2), scaled (2), calibrated (2)

end NXT.Direct_Commands.Inputs;
