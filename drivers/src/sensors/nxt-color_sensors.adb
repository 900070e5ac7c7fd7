--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;     use Ada.Real_Time;
with Interfaces;        use Interfaces;
with NXT.AVR;
with NXT.Bytes;         use NXT.Bytes;
with NXT.Color_Lines;   use NXT.Color_Lines;
with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Color_Sensors is

   --  The sensor grounds the analogue line
   Plugged_Up_To : constant ADC_Value := 50;

   --  Count of the phototransistor in darkness, 214 mV
   Dark : constant := 71;

   Edge_Time  : constant Time_Span := Milliseconds (1);
   Reset_Time : constant Time_Span := Milliseconds (100);

   --  In the calibration: factors of 4 bytes, limits of 2, the sum with its higher byte first
   Row_Bytes   : constant := 16;
   First_Limit : constant := 49;
   Data_Length : constant := 52;

   --  Check sum: CRC-16 (x^16 + x^15 + x^2 + 1), lowest bit first, begun with this value
   First_Sum  : constant Unsigned_16 := 16#5AA5#;
   Polynomial : constant Unsigned_16 := 16#A001#;

   Code_Of : constant array (Lamp_Mode) of Mode_Code :=
     (All_Lamps => 13, Red_Lamp => 14, Green_Lamp => 15, Blue_Lamp => 16, No_Lamp => 17);

   function Id (This : Color_Sensor) return Sensor_Id is (This.Port);

   function Mode (This : Color_Sensor) return Lamp_Mode is (This.Mode);

   function Sum_Of (Data : Byte_Array) return Unsigned_16 is
   begin
      return Sum : Unsigned_16 := First_Sum do
         for Item of Data loop
            Sum := Sum xor Unsigned_16 (Item);
            for Bit in 1 .. 8 loop
               Sum := Shift_Right (Sum, 1) xor (if (Sum and 1) = 1 then Polynomial else 0);
            end loop;
         end loop;
      end return;
   end Sum_Of;

   function Is_Valid (Data : Calibration) return Boolean is
     (Sum_Of (Data (1 .. Data_Length)) = 256 * Unsigned_16 (Data (53)) + Unsigned_16 (Data (54)));

   --  Larger factors than any sensor has would overflow later.
   Largest_Factor : constant Unsigned_32 := 16#1F_FFFF#;

   procedure Store_Calibration (This : in out Color_Sensor; Data : Calibration) is
      Place : Positive;
   begin
      for Line in Row loop
         for Column in Factors'Range (2) loop
            Place := 1 + Row_Bytes * Natural (Line) + 4 * Column;
            This.Factor (Line, Column) :=
              Natural (Unsigned_32'Min (To_Word (Data (Place .. Place + 3)), Largest_Factor));
         end loop;
      end loop;
      for Number in Limits'Range loop
         Place := First_Limit + 2 * Number;
         This.Limit (Number) :=
           ADC_Value (Natural'Min (Natural (Data (Place)) + 256 * Natural (Data (Place + 1)),
                                   Natural (ADC_Value'Last)));
      end loop;
   end Store_Calibration;

   function Is_Plugged (Port : Sensor_Id) return Boolean is
     (NXT.AVR.Reading (Port) <= Plugged_Up_To);

   --  Clock high, low, high and low for long, with the data high.
   procedure Reset_Sensor (Port : Sensor_Id) is
      Next : Time := Clock;
   begin
      Set_Pin_State (Port, Digital_0, High);
      Set_Pin_State (Port, Digital_1, High);
      Set_Pin_Mode (Port, Digital_0, Output);
      Set_Pin_Mode (Port, Digital_1, Output);
      for Level in Pin_States loop
         Next := Next + Edge_Time;
         delay until Next;
         Set_Pin_State (Port, Digital_0, Level);
      end loop;
      Next := Next + Edge_Time;
      delay until Next;
      Set_Pin_State (Port, Digital_0, Low);
      delay until Next + Reset_Time;
   end Reset_Sensor;

   procedure Start (This : in out Color_Sensor; Status : out Measurement_Status) is
      Answer : Calibration;
   begin
      This.Ready := False;
      Status := No_Sensor;
      if not Is_Plugged (This.Port) then
         return;
      end if;
      Reset_Sensor (This.Port);
      Exchange (This.Port, Code_Of (This.Mode), Answer);
      Set_Pin_Mode (This.Port, Digital_0, Input);
      Set_Pin_Mode (This.Port, Digital_1, ADC);
      if Is_Valid (Answer) then
         Store_Calibration (This, Answer);
         This.Ready := True;
         Status := Measured;
      elsif Is_Plugged (This.Port) then
         Status := Wrong_Checksum;
      end if;
   end Start;

   procedure Set_Mode
     (This : in out Color_Sensor; Mode : Lamp_Mode; Status : out Measurement_Status) is
   begin
      This.Mode := Mode;
      Start (This, Status);
   end Set_Mode;

   procedure Take
     (This : in out Color_Sensor; Result : out Counts; Status : out Measurement_Status)
   is
      Lost : Boolean;
   begin
      Result := (others => 0);
      Status := Measured;
      if not This.Ready then
         Start (This, Status);
      end if;
      if Status = Measured then
         Sample (This.Port, This.Mode = All_Lamps, Result, Lost);
         if Lost or else not Is_Plugged (This.Port) then
            This.Ready := False;
            Status := No_Sensor;
         end if;
      end if;
   end Take;

   function Row_For (This : Color_Sensor; Background : ADC_Value) return Row is
     (if Background < This.Limit (1) then 2 elsif Background < This.Limit (0) then 1 else 0);

   function Scaled (Difference : Integer; Factor : Natural) return Intensity is
     (Intensity
        (Integer'Min (Integer'Max (Difference, 0) * Factor / 2 ** 16, Integer (Intensity'Last))));

   procedure Measure
     (This : in out Color_Sensor; Seen : out Surface; Status : out Measurement_Status)
   is
      Found : Counts;
   begin
      Take (This, Found, Status);
      if Status /= Measured then
         Seen := (others => <>);
         return;
      end if;
      declare
         Line : constant Row := Row_For (This, Found (Off));

         function Part (Lit : Lamp; Column : Natural) return Intensity is
           (Scaled (Integer (Found (Lit)) - Integer (Found (Off)), This.Factor (Line, Column)));

      begin
         Seen :=
           (Red        => Part (Red, 0),
            Green      => Part (Green, 1),
            Blue       => Part (Blue, 2),
            Background => Scaled
              ((Integer (Found (Off)) - Dark) * Integer (ADC_Value'Last)
               / (Integer (ADC_Value'Last) - Dark),
               This.Factor (Line, 3)));
      end;
   end Measure;

   --  Brightest part below which a surface is black
   Black_Below : constant Intensity := 50;
   --  With the weakest part above this share of the strongest, in 1/16, a surface has no colour.
   White_Share : constant := 10;
   --  Without colour, a surface is white from here on.
   White_From  : constant Intensity := 95;

   function Color_Of (Seen : Surface) return Color is
      R : constant Integer := Integer (Seen.Red);
      G : constant Integer := Integer (Seen.Green);
      B : constant Integer := Integer (Seen.Blue);
      Strongest : constant Integer := Integer'Max (R, Integer'Max (G, B));
      Weakest   : constant Integer := Integer'Min (R, Integer'Min (G, B));
   begin
      if Strongest < Integer (Black_Below) then
         return Black;
      elsif 16 * Weakest >= White_Share * Strongest then
         return (if Strongest >= Integer (White_From) then White else Black);
      elsif B = Strongest then
         return Blue;
      elsif 2 * G >= R and then 2 * R >= G and then 3 * B < 2 * Integer'Min (R, G) then
         return Yellow;
      elsif R > G then
         return Red;
      else
         return Green;
      end if;
   end Color_Of;

   procedure Read_Color
     (This : in out Color_Sensor; Seen : out Color; Status : out Measurement_Status)
   is
      Parts : Surface;
   begin
      Measure (This, Parts, Status);
      Seen := (if Status = Measured then Color_Of (Parts) else No_Color);
   end Read_Color;

   procedure Measure_Light
     (This : in out Color_Sensor; Level : out Percentage; Status : out Measurement_Status)
   is
      Found : Counts;
      Light : Integer;
   begin
      Take (This, Found, Status);
      Light := Integer'Max (Integer (Found (Off)) - Dark, 0);
      Level := 100 * Light / (Integer (ADC_Value'Last) - Dark);
   end Measure_Light;

end NXT.Color_Sensors;
