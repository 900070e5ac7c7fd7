--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Parallel input and output controller A (datasheet, chapter PIO) and how the brick wires it.
--  Writing ones to a pair such as Enable_Output and Disable_Output changes those lines only, so
--  no read-modify-write is needed and drivers do not disturb each other.

with System;

package NXT.Registers.PIO is

   type Peripheral is record
      Take_Line            : Word with Atomic;
      Give_To_Peripheral   : Word with Atomic;
      Enable_Output        : Word with Atomic;
      Disable_Output       : Word with Atomic;
      Enable_Filter        : Word with Atomic;
      Disable_Filter       : Word with Atomic;
      Set_Output           : Word with Atomic;
      Clear_Output         : Word with Atomic;
      Pin_Levels           : Word with Atomic;
      Enable_Interrupt     : Word with Atomic;
      Disable_Interrupt    : Word with Atomic;
      Interrupt_Mask       : Word with Atomic;
      Changed              : Word with Atomic;
      Enable_Open_Drain    : Word with Atomic;
      Disable_Open_Drain   : Word with Atomic;
      Disable_Pull_Up      : Word with Atomic;
      Enable_Pull_Up       : Word with Atomic;
      Select_A             : Word with Atomic;
      Select_B             : Word with Atomic;
   end record;
   --  Changed: lines with an edge since it was last read; reading clears it.

   for Peripheral use record
      Take_Line            at 16#00# range 0 .. 31;
      Give_To_Peripheral   at 16#04# range 0 .. 31;
      Enable_Output        at 16#10# range 0 .. 31;
      Disable_Output       at 16#14# range 0 .. 31;
      Enable_Filter        at 16#20# range 0 .. 31;
      Disable_Filter       at 16#24# range 0 .. 31;
      Set_Output           at 16#30# range 0 .. 31;
      Clear_Output         at 16#34# range 0 .. 31;
      Pin_Levels           at 16#3C# range 0 .. 31;
      Enable_Interrupt     at 16#40# range 0 .. 31;
      Disable_Interrupt    at 16#44# range 0 .. 31;
      Interrupt_Mask       at 16#48# range 0 .. 31;
      Changed              at 16#4C# range 0 .. 31;
      Enable_Open_Drain    at 16#50# range 0 .. 31;
      Disable_Open_Drain   at 16#54# range 0 .. 31;
      Disable_Pull_Up      at 16#60# range 0 .. 31;
      Enable_Pull_Up       at 16#64# range 0 .. 31;
      Select_A             at 16#70# range 0 .. 31;
      Select_B             at 16#74# range 0 .. 31;
   end record;

   PIOA : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_F400#);

   --  Lines as the brick wires them (LEGO MINDSTORMS NXT Hardware Developer Kit, schematics)
   TWI_Data         : constant Line := 3;
   TWI_Clock        : constant Line := 4;
   RS485_Receive    : constant Line := 5;
   RS485_Send       : constant Line := 6;
   RS485_Direction  : constant Line := 7;
   Display_Select   : constant Line := 10;
   Display_Data     : constant Line := 12;
   --  Low for a command, high for pixels; the line is the SPI's unused input.
   SPI_Output       : constant Line := 13;
   SPI_Clock        : constant Line := 14;

   Bluetooth_Reset  : constant Line := 11;
   --  Active low.
   USB_Pull_Up      : constant Line := 16;
   --  Low: the brick appears on the bus.
   Sound_Output     : constant Line := 17;
   Bluetooth_Input  : constant Line := 21;
   Bluetooth_Output : constant Line := 22;
   Bluetooth_Ready  : constant Line := 24;
   Bluetooth_Go     : constant Line := 25;
   --  Request and clear to send, active low.
   Bluetooth_Stream : constant Line := 27;
   --  High: the chip wants the stream mode.
   Bluetooth_Select : constant Line := 31;
   --  Chip select of the module's own memory, active low: never used.

   type Motor_Lines is array (Motor_Id) of Line;
   Tachometer : constant Motor_Lines := (Motor_A => 15, Motor_B => 26, Motor_C => 0);
   Direction  : constant Motor_Lines := (Motor_A => 1, Motor_B => 9, Motor_C => 8);

   type Sensor_Lines is array (Sensor_Id) of Line;
   Digital_0  : constant Sensor_Lines := (23, 28, 29, 30);
   Digital_1  : constant Sensor_Lines := (18, 19, 20, 2);

end NXT.Registers.PIO;
