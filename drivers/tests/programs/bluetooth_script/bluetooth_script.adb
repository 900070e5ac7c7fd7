--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Starts the Bluetooth module, names the brick, lets it be found.

with Ada.Real_Time;
with NXT.Bluetooth;  use NXT.Bluetooth;

procedure Bluetooth_Script is

   Ready : Integer := -1 with Volatile, Export, Convention => C, External_Name => "ready";
   Ended : Integer := 0 with Volatile, Export, Convention => C, External_Name => "ended";

   Name : Friendly_Name;
begin
   Initialize;
   Ready := Boolean'Pos (Available);
   Convert_To_Friendly_Name ("Ada", Name);
   Set_Friendly_Name (Name);
   Set_Discoverable (True);
   Ended := 1;
   delay until Ada.Real_Time.Time_Last;
end Bluetooth_Script;
