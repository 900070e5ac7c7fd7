--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Ada.Unchecked_Conversion;
with NXT.Priorities;

package body NXT.Telemetry is

   function Bits is new Ada.Unchecked_Conversion (Float, Unsigned_32);
   function Bits is new Ada.Unchecked_Conversion (Integer, Unsigned_32);

   function Of_Real (Item : Float) return Value is (Value (Bits (Item)));
   function Of_Whole (Item : Integer) return Value is (Value (Bits (Item)));
   function Of_Truth (Item : Boolean) return Value is (Boolean'Pos (Item));

   Counts : array (Group_Id) of Natural range 0 .. Group_Size := (others => 0);

   function Signal_Count (Group : Group_Id) return Natural is (Counts (Group));

   function Parameter_Count return Natural is (Last_Declared);

   function To_Title (Name, Unit : String) return Title is
   begin
      return Result : Title do
         Result.Name_Last := Name'Length;
         Result.Unit_Last := Unit'Length;
         Result.Name := (others => ' ');
         Result.Unit := (others => ' ');
         Result.Name (1 .. Name'Length) := Name;
         Result.Unit (1 .. Unit'Length) := Unit;
      end return;
   end To_Title;

   procedure Declare_Signal (Group : Group_Id; Name : String; Unit : String; As : Kind) is
   begin
      Counts (Group) := Counts (Group) + 1;
      Last_Signal := Last_Signal + 1;
      Signals (Last_Signal) := (Group, Short_Index (Counts (Group)), As, To_Title (Name, Unit));
   end Declare_Signal;

   function Declare_Parameter
     (Name : String; Unit : String; Minimum, Maximum, Initial : Float) return Parameter
   is
      Item : constant Parameter := Parameter (Last_Declared + 1);
   begin
      Last_Declared := Last_Declared + 1;
      Parameters (Item) := (Minimum, Maximum, To_Title (Name, Unit));
      In_Force (Item) := Initial;
      return Item;
   end Declare_Parameter;

   function Current (Item : Parameter) return Float is (In_Force (Item));

   --  Samples on their way

   Capacity : constant := 24;
   type Place is mod Capacity;
   type Slots is array (Place) of Sample_Slot;
   type Numbers is array (Group_Id) of Unsigned_16;

   protected Queue with Priority => Priorities.Shared_Data is
      procedure Put (Group : Group_Id; Sample : Values);
      procedure Take (Slot : out Sample_Slot; Found : out Boolean);
      procedure Listen (Now : Boolean);
      function Dropped return Unsigned_32;
   private
      Kept      : Slots;
      Oldest    : Place := 0;
      Length    : Natural range 0 .. Capacity := 0;
      Next      : Numbers := (others => 0);
      Losses    : Unsigned_32 := 0;
      Listening : Boolean := False;
   end Queue;

   protected body Queue is

      procedure Put (Group : Group_Id; Sample : Values) is
      begin
         if not Listening then
            return;
         end if;
         if Length = Capacity then
            Oldest := Oldest + 1;
            Length := Length - 1;
            Losses := Losses + 1;
         end if;
         declare
            Slot : Sample_Slot renames Kept (Oldest + Place (Length));
         begin
            Slot.Taken := Clock;
            Slot.Number := Next (Group);
            Slot.Group := Group;
            Slot.Count := Sample'Length;
            Slot.Data (Sample'Range) := Sample;
         end;
         Length := Length + 1;
         Next (Group) := Next (Group) + 1;
      end Put;

      procedure Take (Slot : out Sample_Slot; Found : out Boolean) is
      begin
         Found := Length > 0;
         Slot := Kept (Oldest);
         if Found then
            Oldest := Oldest + 1;
            Length := Length - 1;
         end if;
      end Take;

      procedure Listen (Now : Boolean) is
      begin
         Listening := Now;
         Length := 0;
      end Listen;

      function Dropped return Unsigned_32 is (Losses);

   end Queue;

   procedure Publish (Group : Group_Id; Sample : Values) is
   begin
      Queue.Put (Group, Sample);
   end Publish;

   procedure Take (Slot : out Sample_Slot; Found : out Boolean) is
   begin
      Queue.Take (Slot, Found);
   end Take;

   procedure Listen (Now : Boolean) is
   begin
      Queue.Listen (Now);
   end Listen;

   function Dropped return Unsigned_32 is (Queue.Dropped);

end NXT.Telemetry;
