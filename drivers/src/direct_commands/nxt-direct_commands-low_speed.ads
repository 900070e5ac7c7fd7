--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sensors on a two-wire bus as the protocol sees them: a transaction is begun, asked about, and
--  its bytes are fetched. Nothing waits.

private package NXT.Direct_Commands.Low_Speed is

   Longest : constant := 16;
   subtype Data_Bytes is Byte_Array (1 .. Longest);

   procedure Open (Port : Sensor_Id; Supply : Sensor_Power);

   procedure Close (Port : Sensor_Id);
   --  The port's lines become inputs, if it was open.

   procedure Write (Port : Sensor_Id; Data : Byte_Array; Wanted : Byte; Status : out Byte);
   --  Send Data, the first of which is the device, then take Wanted bytes from it.

   procedure Get_Status (Port : Sensor_Id; Ready : out Byte; Status : out Byte);
   --  How many bytes can be fetched; a transaction that goes on or has failed is a status.

   procedure Read
     (Port : Sensor_Id; Data : out Data_Bytes; Count : out Byte; Status : out Byte);

end NXT.Direct_Commands.Low_Speed;
