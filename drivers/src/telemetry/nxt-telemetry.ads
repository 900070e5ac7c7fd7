--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Signals that a program publishes and parameters that it lets be changed while it runs.
--
--  Publishing copies a few words and never waits: when the link is slower than the program the
--  oldest samples are dropped, and counted. NXT.Telemetry.Server carries them over a link.
--  Names and parameters are to be declared before the tasks begin, from the main program's
--  environment or library packages; a declaration beyond the capacity is a failed precondition.

with Interfaces;  use Interfaces;
private with Ada.Real_Time;

package NXT.Telemetry is

   Name_Length : constant := 15;
   Unit_Length : constant := 7;

   --  Signals

   Maximum_Group : constant := 4;
   Group_Size    : constant := 8;
   type Group_Id is range 1 .. Maximum_Group;
   subtype Signal_Index is Positive range 1 .. Group_Size;
   --  The signals of a group are sampled together.

   type Kind is (Real, Whole, Truth);

   type Value is private;
   function Of_Real (Item : Float) return Value;
   function Of_Whole (Item : Integer) return Value;
   function Of_Truth (Item : Boolean) return Value;

   type Values is array (Signal_Index range <>) of Value;

   function Signal_Count (Group : Group_Id) return Natural;

   procedure Declare_Signal (Group : Group_Id; Name : String; Unit : String; As : Kind) with
     Pre => Name'Length in 1 .. Name_Length
            and then Unit'Length <= Unit_Length
            and then Signal_Count (Group) < Group_Size;
   --  The next signal of the group.

   procedure Publish (Group : Group_Id; Sample : Values) with
     Pre => Sample'First = 1 and then Sample'Length = Signal_Count (Group);
   --  The group's signals at this instant. Callable from tasks and from protected actions.

   --  Parameters

   Maximum_Parameter : constant := 16;
   type Parameter is private;

   function Parameter_Count return Natural;

   function Declare_Parameter
     (Name : String; Unit : String; Minimum, Maximum, Initial : Float) return Parameter
   with Pre => Name'Length in 1 .. Name_Length
               and then Unit'Length <= Unit_Length
               and then Minimum <= Initial and then Initial <= Maximum
               and then Parameter_Count < Maximum_Parameter;

   function Current (Item : Parameter) return Float;
   --  The value in force, always within the limits; one load.

   --  Totals since power-on

   function Dropped return Unsigned_32;
   --  Samples that were given up because the link is too slow.

private

   type Value is new Unsigned_32;

   type Signal_Number is range 0 .. Maximum_Group * Group_Size;
   type Parameter is range 1 .. Maximum_Parameter;

   subtype Name_Text is String (1 .. Name_Length);
   subtype Unit_Text is String (1 .. Unit_Length);

   type Text_Length is range 0 .. Name_Length with Size => 8;

   type Title is record
      Name      : Name_Text;
      Unit      : Unit_Text;
      Name_Last : Text_Length := 0;
      Unit_Last : Text_Length := 0;
   end record;

   type Short_Index is new Signal_Index with Size => 8;

   type Signal is record
      Group : Group_Id;
      Index : Short_Index;
      As    : Kind;
      Text  : Title;
   end record;

   type Limits is record
      Minimum, Maximum : Float;
      Text             : Title;
   end record;

   Signals       : array (Signal_Number range 1 .. Signal_Number'Last) of Signal;
   Last_Signal   : Signal_Number := 0;
   Parameters    : array (Parameter) of Limits;
   Last_Declared : Natural range 0 .. Maximum_Parameter := 0;

   type Parameter_Values is array (Parameter) of Float with Atomic_Components;
   In_Force : Parameter_Values := (others => 0.0);

   subtype Words is Values (Signal_Index);

   type Sample_Slot is record
      Taken  : Ada.Real_Time.Time;
      Number : Unsigned_16;
      Group  : Group_Id;
      Count  : Natural range 0 .. Group_Size;
      Data   : Words;
   end record;

   procedure Take (Slot : out Sample_Slot; Found : out Boolean);
   --  The oldest sample, taken from the queue.

   procedure Listen (Now : Boolean);
   --  Whether somebody does. At each call the queue is emptied, and what is forgotten then, or
   --  published to nobody, does not count as dropped.

end NXT.Telemetry;
