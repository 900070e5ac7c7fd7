--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;
with NXT.AVR;
with NXT.Motor_Encoders;  use NXT.Motor_Encoders;

package body NXT.Direct_Commands.Outputs is

   function To_Unsigned is new Ada.Unchecked_Conversion (Integer, Unsigned_32);
   function To_Signed is new Ada.Unchecked_Conversion (Byte, Integer_8);

   --  Bits of the mode
   Motor_On : constant Byte := 1;
   Brake    : constant Byte := 2;

   Idle         : constant Byte := 0;
   Success      : constant Byte := 16#00#;
   Out_Of_Range : constant Byte := 16#C0#;

   Limit_First : constant := 6;

   type Output is record
      Setting         : Byte_Array (1 .. Setting_Length) := (others => 0);
      Limit           : Unsigned_32 := 0;
      Command_Origin  : Integer := 0;
      Block_Origin    : Integer := 0;
      Rotation_Origin : Integer := 0;
   end record;
   --  Limit: degrees until the motor stops; 0 for none.

   All_Outputs : array (Motor_Id) of Output;

   function Is_Addressed (Motor : Motor_Id; Port : Byte) return Boolean is
     (Port = All_Ports or else Byte (Motor_Id'Pos (Motor)) = Port);

   procedure Drive (Motor : Motor_Id; Item : Output) is
      Power : constant Integer_8 := To_Signed (Item.Setting (1));
      Mode  : constant Byte := Item.Setting (2);
      Runs  : constant Boolean := (Mode and Motor_On) /= 0 and then Item.Setting (5) /= Idle;
   begin
      NXT.AVR.Set_Output
        (Motor,
         Duty           => (if Runs then PWM_Value (Power) else 0),
         Short_When_Off => (Mode and Brake) /= 0);
   end Drive;

   procedure Set (Port : Byte; Setting : Byte_Array; Status : out Byte) is
      Power : constant Integer_8 := To_Signed (Setting (Setting'First));
   begin
      if Power not in Integer_8 (PWM_Value'First) .. Integer_8 (PWM_Value'Last) then
         Status := Out_Of_Range;
         return;
      end if;
      Status := Success;
      for Motor in Motor_Id loop
         if Is_Addressed (Motor, Port) then
            declare
               Item : Output renames All_Outputs (Motor);
            begin
               Item.Setting := Setting (Setting'First .. Setting'First + Setting_Length - 1);
               Item.Limit := To_Word (Item.Setting (Limit_First .. Setting_Length));
               Item.Command_Origin := Encoder_Count (Motor);
               Drive (Motor, Item);
            end;
         end if;
      end loop;
   end Set;

   function State (Port : Byte) return Byte_Array is
      Motor : constant Motor_Id := Motor_Id'Val (Port);
      Item  : Output renames All_Outputs (Motor);
      Count : constant Integer := Encoder_Count (Motor);
   begin
      return (1 => Port) & Item.Setting
        & To_Bytes (To_Unsigned (Count - Item.Command_Origin))
        & To_Bytes (To_Unsigned (Count - Item.Block_Origin))
        & To_Bytes (To_Unsigned (Count - Item.Rotation_Origin));
   end State;

   procedure Reset_Position (Port : Byte; Relative : Boolean) is
   begin
      for Motor in Motor_Id loop
         if Is_Addressed (Motor, Port) then
            if Relative then
               All_Outputs (Motor).Block_Origin := Encoder_Count (Motor);
            else
               All_Outputs (Motor).Rotation_Origin := Encoder_Count (Motor);
            end if;
         end if;
      end loop;
   end Reset_Position;

   procedure Stop_At_Limits is
   begin
      for Motor in Motor_Id loop
         declare
            Item : Output renames All_Outputs (Motor);
            Way  : constant Unsigned_32 :=
              To_Unsigned (abs (Encoder_Count (Motor) - Item.Command_Origin));
         begin
            if Item.Limit /= 0 and then Item.Setting (5) /= Idle and then Way >= Item.Limit then
               Item.Setting (1) := 0;
               Item.Setting (5) := Idle;
               Drive (Motor, Item);
            end if;
         end;
      end loop;
   end Stop_At_Limits;

end NXT.Direct_Commands.Outputs;
