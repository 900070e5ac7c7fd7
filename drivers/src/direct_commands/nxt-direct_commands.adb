--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;                   use Interfaces;
with NXT.Audio;
with NXT.Battery;
with NXT.Direct_Commands.Inputs;
with NXT.Direct_Commands.Low_Speed;
with NXT.Direct_Commands.Outputs;

package body NXT.Direct_Commands is

   --  First byte of a telegram
   No_Reply       : constant Byte := 16#80#;
   Direct         : constant Byte := 16#00#;
   System_Command : constant Byte := 16#01#;
   Reply_Mark     : constant Byte := 16#02#;

   --  Status of a reply
   Success       : constant Byte := 16#00#;
   Unknown       : constant Byte := 16#BE#;
   Out_Of_Range  : constant Byte := 16#C0#;
   Wrong_Length  : constant Byte := 16#BF#;

   --  Direct commands
   Play_Tone       : constant Byte := 16#03#;
   Set_Output      : constant Byte := 16#04#;
   Set_Input_Mode  : constant Byte := 16#05#;
   Get_Output      : constant Byte := 16#06#;
   Get_Input       : constant Byte := 16#07#;
   Reset_Scaled    : constant Byte := 16#08#;
   Reset_Position  : constant Byte := 16#0A#;
   Get_Battery     : constant Byte := 16#0B#;
   Stop_Sound      : constant Byte := 16#0C#;
   Keep_Alive      : constant Byte := 16#0D#;
   Bus_Status      : constant Byte := 16#0E#;
   Bus_Write       : constant Byte := 16#0F#;
   Bus_Read        : constant Byte := 16#10#;

   --  System commands
   Get_Version     : constant Byte := 16#88#;
   Get_Device_Info : constant Byte := 16#9B#;

   Version : constant Byte_Array := (124, 1, 0, 1);
   --  Protocol 1.124, firmware 1.0; minor numbers first

   Header_Length : constant := 2;
   Status_Place  : constant := 3;
   Name_Length   : constant := 15;

   Own_Name    : Byte_Array (1 .. Name_Length) := (others => 0);
   Own_Address : Eight_Bytes := (others => 0);

   procedure Set_Identity (Name : String; Address : Eight_Bytes) is
   begin
      Own_Name := (others => 0);
      for Index in 1 .. Name'Length loop
         Own_Name (Index) := Character'Pos (Name (Name'First + Index - 1));
      end loop;
      Own_Address := Address;
   end Set_Identity;

   function Word_At (Item : Byte_Array; Place : Positive) return Unsigned_32 is
     (Unsigned_32 (Item (Item'First + Place - 1))
      + 256 * Unsigned_32 (Item (Item'First + Place)));

   --  A reply grows behind its status.

   type Answer is record
      Status : Byte := Success;
      Data   : Telegram;
      Last   : Natural := Status_Place;
   end record;

   procedure Put (Into : in out Answer; Item : Byte_Array) is
   begin
      Into.Data (Into.Last + 1 .. Into.Last + Item'Length) := Item;
      Into.Last := Into.Last + Item'Length;
   end Put;

   procedure Execute_Tone (Item : Byte_Array; Result : in out Answer) is
      Frequency : constant Unsigned_32 := Word_At (Item, 3);
      Highest   : constant := NXT.Audio.Tone_Rate / 2;
   begin
      if Frequency in 1 .. Highest then
         NXT.Audio.Play_Tone (Frequency, Word_At (Item, 5), NXT.Audio.Maximum_Volume);
      else
         Result.Status := Out_Of_Range;
      end if;
   end Execute_Tone;

   procedure Execute_Output (Item : Byte_Array; Result : in out Answer) is
      Port : constant Byte := Item (Item'First + 2);
   begin
      if not Outputs.Is_Port (Port) then
         Result.Status := Out_Of_Range;
         return;
      end if;
      case Item (Item'First + 1) is
         when Set_Output =>
            Outputs.Set (Port, Item (Item'First + 3 .. Item'Last), Result.Status);
         when Reset_Position =>
            Outputs.Reset_Position (Port, Relative => Item (Item'First + 3) /= 0);
         when others =>
            if Port = Outputs.All_Ports then
               Result.Status := Out_Of_Range;
            else
               Put (Result, Outputs.State (Port));
            end if;
      end case;
   end Execute_Output;

   procedure Execute_Input (Item : Byte_Array; Result : in out Answer) is
      Port : constant Byte := Item (Item'First + 2);
   begin
      if not Inputs.Is_Port (Port) then
         Result.Status := Out_Of_Range;
         return;
      end if;
      case Item (Item'First + 1) is
         when Set_Input_Mode =>
            Inputs.Set (Port, Item (Item'First + 3), Item (Item'First + 4), Result.Status);
         when Get_Input =>
            Put (Result, Inputs.Values (Port));
         when others =>
            null;
      end case;
   end Execute_Input;

   procedure Execute_Bus_Write (Port : Sensor_Id; Item : Byte_Array; Result : in out Answer) is
      First  : constant Positive := Item'First + 5;
      Length : constant Natural := Natural (Item (Item'First + 3));
   begin
      if Item'Last - First + 1 < Length then
         Result.Status := Wrong_Length;
      else
         Low_Speed.Write
           (Port, Item (First .. First + Length - 1), Item (Item'First + 4), Result.Status);
      end if;
   end Execute_Bus_Write;

   procedure Execute_Bus (Item : Byte_Array; Result : in out Answer) is
      Port  : constant Byte := Item (Item'First + 2);
      Data  : Low_Speed.Data_Bytes;
      Count : Byte;
   begin
      if not Inputs.Is_Port (Port) then
         Result.Status := Out_Of_Range;
         return;
      end if;
      case Item (Item'First + 1) is
         when Bus_Write =>
            Execute_Bus_Write (Sensor_Id'Val (Port), Item, Result);
         when Bus_Status =>
            Low_Speed.Get_Status (Sensor_Id'Val (Port), Count, Result.Status);
            Put (Result, (1 => Count));
         when others =>
            Low_Speed.Read (Sensor_Id'Val (Port), Data, Count, Result.Status);
            Put (Result, Count & Data);
      end case;
   end Execute_Bus;

   procedure Execute_Direct (Item : Byte_Array; Result : in out Answer) is
   begin
      case Item (Item'First + 1) is
         when Play_Tone =>
            Execute_Tone (Item, Result);
         when Set_Output | Get_Output | Reset_Position =>
            Execute_Output (Item, Result);
         when Set_Input_Mode | Get_Input | Reset_Scaled =>
            Execute_Input (Item, Result);
         when Bus_Status | Bus_Write | Bus_Read =>
            Execute_Bus (Item, Result);
         when Get_Battery =>
            Put (Result, To_Bytes (Unsigned_16 (NXT.Battery.Voltage)));
         when Stop_Sound =>
            NXT.Audio.Stop;
         when Keep_Alive =>
            Put (Result, To_Bytes (Unsigned_32'(0)));
         when others =>
            Result.Status := Unknown;
      end case;
   end Execute_Direct;

   procedure Execute_System (Item : Byte_Array; Result : in out Answer) is
   begin
      case Item (Item'First + 1) is
         when Get_Version =>
            Put (Result, Version);
         when Get_Device_Info =>
            Put (Result, Own_Name);
            Put (Result, Own_Address (1 .. 7));
            Put (Result, To_Bytes (Unsigned_32'(0)));
            Put (Result, To_Bytes (Unsigned_32'(0)));
         when others =>
            Result.Status := Unknown;
      end case;
   end Execute_System;

   --  Length of the direct commands that are known; all system commands may have any.
   function Length_Of (Code : Byte) return Natural is
     (case Code is
         when Play_Tone      => 6,
         when Set_Output     => 12,
         when Set_Input_Mode => 5,
         when Reset_Position => 4,
         when Get_Output | Get_Input | Reset_Scaled | Bus_Status | Bus_Read => 3,
         when Bus_Write      => 5,
         when others         => Header_Length);

   procedure Execute (Item : Byte_Array; Reply : out Telegram; Last : out Natural) is
      Result : Answer;
      Class  : Byte;
   begin
      Reply := (others => 0);
      Last := 0;
      if Item'Length < Header_Length then
         return;
      end if;
      Class := Item (Item'First) and not No_Reply;
      Result.Data := (others => 0);
      if Class = System_Command then
         Execute_System (Item, Result);
      elsif Class /= Direct then
         return;
      elsif Item'Length < Length_Of (Item (Item'First + 1)) then
         Result.Status := Wrong_Length;
      else
         Execute_Direct (Item, Result);
      end if;
      if (Item (Item'First) and No_Reply) = 0 then
         Reply := Result.Data;
         Reply (1) := Reply_Mark;
         Reply (2) := Item (Item'First + 1);
         Reply (Status_Place) := Result.Status;
         Last := Result.Last;
      end if;
   end Execute;

   procedure Tick is
   begin
      Outputs.Stop_At_Limits;
   end Tick;

end NXT.Direct_Commands;
