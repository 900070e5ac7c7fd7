--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;
with NXT.Last_Chance;
pragma Unreferenced (NXT.Last_Chance);
with NXT.Priorities;

package body NXT.LCD is

   use Ada.Real_Time;
   use Interfaces;

   --  The controller needs 10 ms and less after power-up and after a reset (UC1601 datasheet,
   --  reset and power management).
   Reset_Time : constant Time_Span := Milliseconds (20);

   subtype Page_Address is SPI.Byte_Array (1 .. 3);

   function Address_Of (Page : Pixel_Rows) return Page_Address is
     (16#B0# or Unsigned_8 (Page), 16#10#, 16#00#);

   Page_Addresses : constant array (Pixel_Rows) of Page_Address :=
     (Address_Of (0), Address_Of (1), Address_Of (2), Address_Of (3),
      Address_Of (4), Address_Of (5), Address_Of (6), Address_Of (7));

   type Buffer_Number is range 1 .. 2;

   Buffers  : array (Buffer_Number) of Picture;
   Commands : array (Buffer_Number, Pixel_Rows) of aliased SPI.Segment;
   Pixels   : array (Buffer_Number, Pixel_Rows) of aliased SPI.Segment;
   --  The lists of both buffers: each page with its address before it.

   type Block is array (1 .. 10) of Unsigned_32;
   type Blocks is array (1 .. Picture'Size / Block'Size) of Block;
   --  What some registers hold: a picture is copied in half the time, for which tasks wait.

   protected Frames with Priority => Priorities.Shared_Data is
      procedure Show (Content : Picture);
   private
      Latest : Buffer_Number := 1;
   end Frames;
   --  Latest: the buffer that was submitted last. The other one has been sent.

   protected body Frames is

      procedure Show (Content : Picture) is
         Withdrawn : Boolean;
         Source    : Blocks with Import, Address => Content'Address;
      begin
         SPI.Withdraw (Withdrawn);
         if not Withdrawn then
            Latest := 3 - Latest;
         end if;
         declare
            Target : Blocks with Import, Address => Buffers (Latest)'Address;
         begin
            for Part in Blocks'Range loop
               Target (Part) := Source (Part);
            end loop;
         end;
         SPI.Submit (Commands (Latest, 0)'Access);
      end Show;

   end Frames;

   procedure Command (Bytes : SPI.Byte_Array) is
   begin
      SPI.Send (SPI.Command, Bytes'Address, Bytes'Length);
   end Command;

   procedure Command (Cmd : Unsigned_8) is
   begin
      Command (SPI.Byte_Array'(1 => Cmd));
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
   begin
      Frames.Show (Content);
   end Show;

   procedure Write (Page : Raw_Pages; Start : Raw_Columns; Graph : LCD_Line) is
   begin
      Set_Page_Address (Page);
      Set_Col (Start);
      SPI.Send (SPI.Pixels, Graph'Address, Graph'Length);
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

begin
   for Number in Buffer_Number loop
      for Page in Pixel_Rows loop
         Commands (Number, Page) :=
           (Page_Address'Length, SPI.Command, Page_Addresses (Page)'Address,
            Pixels (Number, Page)'Access);
         Pixels (Number, Page) :=
           (Full_Line'Length, SPI.Pixels, Buffers (Number) (Page)'Address,
            (if Page < Pixel_Rows'Last then Commands (Number, Page + 1)'Access else null));
      end loop;
   end loop;
end NXT.LCD;
