--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Ada.Unchecked_Conversion;

package body NXT.Telemetry.Messages is

   Hello_Code     : constant Byte := 16#01#;
   Signal_Code    : constant Byte := 16#02#;
   Parameter_Code : constant Byte := 16#03#;
   Sample_Code    : constant Byte := 16#04#;
   Answer_Code    : constant Byte := 16#05#;
   Status_Code    : constant Byte := 16#06#;
   Refused_Code   : constant Byte := 16#07#;
   Ask_Code       : constant Byte := 16#41#;
   Set_Code       : constant Byte := 16#42#;
   Alive_Code     : constant Byte := 16#43#;
   Stop_Code      : constant Byte := 16#44#;

   type Verdict is (Accepted, Out_Of_Range, Unknown);

   function To_Float is new Ada.Unchecked_Conversion (Unsigned_32, Float);
   function To_Bits is new Ada.Unchecked_Conversion (Float, Unsigned_32);

   --  Whole microseconds since power-on.
   function To_Us (Instant : Time) return Unsigned_64 is
      Per_Second : constant := 1_000_000;
      Whole      : Seconds_Count;
      Rest       : Time_Span;
      Units      : Natural;
   begin
      Split (Instant, Whole, Rest);
      Units := Rest / Time_Span_Unit;
      return Per_Second * Unsigned_64 (Whole)
        + Per_Second * Unsigned_64 (Units) / Units_Per_Second;
   end To_Us;

   procedure Start (Into : out Builder; Code : Byte) is
   begin
      Into.Data (1) := Code;
      Into.Last := 1;
   end Start;

   procedure Put (Into : in out Builder; Item : Byte_Array) is
   begin
      Into.Data (Into.Last + 1 .. Into.Last + Item'Length) := Item;
      Into.Last := Into.Last + Item'Length;
   end Put;

   procedure Put (Into : in out Builder; Item : Byte) is
   begin
      Into.Last := Into.Last + 1;
      Into.Data (Into.Last) := Item;
   end Put;

   procedure Put (Into : in out Builder; Item : Float) is
   begin
      Put (Into, To_Bytes (To_Bits (Item)));
   end Put;

   procedure Put (Into : in out Builder; Item : String) is
   begin
      Put (Into, Byte (Item'Length));
      for Letter of Item loop
         pragma Annotate (Ravenbrick, Iterations, 15, "the letters of a name");
         Put (Into, Byte (Character'Pos (Letter)));
      end loop;
   end Put;

   procedure Put (Into : in out Builder; Item : Title) is
   begin
      Put (Into, Item.Name (1 .. Natural (Item.Name_Last)));
      Put (Into, Item.Unit (1 .. Natural (Item.Unit_Last)));
   end Put;

   procedure Build_Hello (Into : out Builder; Name : String; Now : Time) is
   begin
      Start (Into, Hello_Code);
      Put (Into, Byte (Protocol_Version));
      Put (Into, Byte (Last_Signal));
      Put (Into, Byte (Parameter_Count));
      Put (Into, To_Bytes (To_Us (Now)));
      Put (Into, Name (Name'First .. Name'First + Natural'Min (Name'Length, Name_Length) - 1));
   end Build_Hello;

   procedure Build_Signal (Into : out Builder; Number : Signal_Number) is
      Item : Signal renames Signals (Number);
   begin
      Start (Into, Signal_Code);
      Put (Into, Byte (Item.Group));
      Put (Into, Byte (Item.Index - 1));
      Put (Into, Byte (Kind'Pos (Item.As)));
      Put (Into, Item.Text);
   end Build_Signal;

   procedure Build_Parameter (Into : out Builder; Item : Parameter) is
   begin
      Start (Into, Parameter_Code);
      Put (Into, Byte (Item) - 1);
      Put (Into, Parameters (Item).Minimum);
      Put (Into, Parameters (Item).Maximum);
      Put (Into, In_Force (Item));
      Put (Into, Parameters (Item).Text);
   end Build_Parameter;

   procedure Build_Sample (Into : out Builder; Slot : Sample_Slot) is
   begin
      Start (Into, Sample_Code);
      Put (Into, Byte (Slot.Group));
      Put (Into, To_Bytes (Slot.Number));
      Put (Into, To_Bytes (Unsigned_32 (To_Us (Slot.Taken) and 16#FFFF_FFFF#)));
      for Item of Slot.Data (1 .. Slot.Count) loop
         pragma Annotate (Ravenbrick, Iterations, 8, "the signals of a group");
         Put (Into, To_Bytes (Unsigned_32 (Item)));
      end loop;
   end Build_Sample;

   --  A value that is not a number is in no range.
   function Check (Index : Byte; Wanted : Float) return Verdict is
   begin
      if Natural (Index) >= Parameter_Count then
         return Unknown;
      end if;
      declare
         Limit : Limits renames Parameters (Parameter (Index + 1));
      begin
         return (if Wanted >= Limit.Minimum and then Wanted <= Limit.Maximum
                 then Accepted else Out_Of_Range);
      end;
   end Check;

   procedure Build_Answer (Into : out Builder; Index : Byte; Value_Bits : Four_Bytes) is
      Wanted : constant Float := To_Float (To_Word (Value_Bits));
      Result : constant Verdict := Check (Index, Wanted);
   begin
      if Result = Accepted then
         In_Force (Parameter (Index + 1)) := Wanted;
      end if;
      Start (Into, Answer_Code);
      Put (Into, Index);
      Put (Into, Byte (Verdict'Pos (Result)));
      Put (Into, (if Result = Unknown then 0.0 else In_Force (Parameter (Index + 1))));
   end Build_Answer;

   procedure Build_Status (Into : out Builder; Sent : Unsigned_32; Damaged : Natural) is
   begin
      Start (Into, Status_Code);
      Put (Into, To_Bytes (Sent));
      Put (Into, To_Bytes (Dropped));
      Put (Into, To_Bytes (Unsigned_32 (Damaged)));
   end Build_Status;

   procedure Build_Refused (Into : out Builder) is
   begin
      Start (Into, Refused_Code);
      Put (Into, Byte (Protocol_Version));
   end Build_Refused;

   Ask_Length : constant := 2;
   Set_Length : constant := 6;

   function Request_In (Item : Frames.Reader) return Request is
      Length : constant Natural := Frames.Content_Length (Item);
   begin
      if Length = 0 then
         return Nothing;
      end if;
      case Frames.Content_Byte (Item, 1) is
         when Ask_Code =>
            return (if Length /= Ask_Length then Nothing
                    elsif Frames.Content_Byte (Item, 2) = Protocol_Version then Ask
                    else Ask_Other_Version);
         when Set_Code   => return (if Length = Set_Length then Set_Parameter else Nothing);
         when Alive_Code => return (if Length = 1 then Keep_Alive else Nothing);
         when Stop_Code  => return (if Length = 1 then Stop else Nothing);
         when others     => return Nothing;
      end case;
   end Request_In;

   procedure Read_Set
     (Item : Frames.Reader; Index : out Byte; Value_Bits : out Four_Bytes) is
   begin
      Index := Frames.Content_Byte (Item, 2);
      Value_Bits := Frames.Content_Word (Item, 3);
   end Read_Set;

end NXT.Telemetry.Messages;
