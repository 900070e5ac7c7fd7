--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;
with NXT.Last_Chance;
pragma Unreferenced (NXT.Last_Chance);

package body NXT.LCD is

   use Ada.Real_Time;
   use Interfaces;

   --  The controller needs 10 ms and less after power-up and after a reset (UC1601 datasheet,
   --  reset and power management).
   Reset_Time : constant Time_Span := Milliseconds (20);

   Shown : Picture;
   --  What the transfer of Show reads.

   subtype Page_Address is SPI.Byte_Array (1 .. 3);

   function Address_Of (Page : Raw_Pages) return Page_Address is
     (16#B0# or Unsigned_8 (Page), 16#10#, 16#00#);

   Page_Addresses : constant array (Raw_Pages) of Page_Address :=
     (Address_Of (0), Address_Of (1), Address_Of (2), Address_Of (3),
      Address_Of (4), Address_Of (5), Address_Of (6), Address_Of (7));

   procedure Command (Bytes : SPI.Byte_Array) is
   begin
      SPI.Send (SPI.Command, Bytes'Address, Bytes'Length);
   end Command;

   procedure Command (Byte : Unsigned_8) is
   begin
      Command (SPI.Byte_Array'(1 => Byte));
   end Command;

   --  Wait without making use of the processor.
   procedure Wait (Span : Time_Span) is
   begin
      delay until Clock + Span;
   end Wait;

   procedure Power_On is
   begin
      Wait (Reset_Time);
      Reset;
      Wait (Reset_Time);
      Command (Set_Up);
   end Power_On;

   procedure Show (Content : Picture) is
      List : SPI.Segment_List (1 .. SPI.Maximum_Segments);
   begin
      for Page in Raw_Pages loop
         List (1 + 2 * Natural (Page)) :=
           (SPI.Command, Page_Addresses (Page)'Address, Page_Address'Length);
         List (2 + 2 * Natural (Page)) :=
           (SPI.Pixels, Shown (Page)'Address, LCD_Line'Length);
      end loop;
      SPI.Await_Idle;
      Shown := Content;
      SPI.Start (List);
   end Show;

   procedure Write (Page : Raw_Pages; Content : LCD_Line) is
   begin
      Command (Page_Addresses (Page));
      SPI.Send (SPI.Pixels, Content'Address, Content'Length);
   end Write;

   procedure Reset is
   begin
      Command (Reset_Command);
   end Reset;

   procedure Set_Display_Enable (On : Boolean) is
   begin
      Command (16#AE# + Boolean'Pos (On));
   end Set_Display_Enable;

   procedure Set_All_Pixels_On (On : Boolean) is
   begin
      Command (16#A4# + Boolean'Pos (On));
   end Set_All_Pixels_On;

   procedure Set_Inverse_Display (On : Boolean) is
   begin
      Command (16#A6# + Boolean'Pos (On));
   end Set_Inverse_Display;

   procedure Set_Bias_Ratio (Br : Bias_Ratio) is
   begin
      Command (16#E8# or Br);
   end Set_Bias_Ratio;

   procedure Set_Pot (Pm : Unsigned_8) is
   begin
      Command (SPI.Byte_Array'(16#81#, Pm));
   end Set_Pot;

   procedure Set_Ram_Address_Control (Ac : Address_Control) is
   begin
      Command (16#88# or Ac);
   end Set_Ram_Address_Control;

   procedure Set_Map_Control (M : Mapping) is
   begin
      Command (16#C0# or 2 * M);
   end Set_Map_Control;

   procedure Set_Col (Ca : Raw_Columns) is
      Column : constant Unsigned_8 := Unsigned_8 (Ca);
   begin
      Command (SPI.Byte_Array'(Column mod 16, 16#10# or Column / 16));
   end Set_Col;

   procedure Set_Page_Address (Pa : Raw_Pages) is
   begin
      Command (16#B0# or Unsigned_8 (Pa));
   end Set_Page_Address;

   procedure Set_Scroll (N : Scroll_Lines) is
   begin
      Command (16#40# or N);
   end Set_Scroll;

end NXT.LCD;
