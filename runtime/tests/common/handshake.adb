--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements; use System.Storage_Elements;

package body Handshake is

   type Word is mod 2 ** 32;

   PIO_Disable     : Word with Import, Volatile, Address => To_Address (16#FFFF_F404#);
   PIO_Select_A    : Word with Import, Volatile, Address => To_Address (16#FFFF_F470#);
   PMC_Enable      : Word with Import, Volatile, Address => To_Address (16#FFFF_FC10#);
   TWI_Control     : Word with Import, Volatile, Address => To_Address (16#FFFB_8000#);
   TWI_Master_Mode : Word with Import, Volatile, Address => To_Address (16#FFFB_8004#);
   TWI_Waveform    : Word with Import, Volatile, Address => To_Address (16#FFFB_8010#);
   TWI_Status      : Word with Import, Volatile, Address => To_Address (16#FFFB_8020#);
   TWI_Transmit    : Word with Import, Volatile, Address => To_Address (16#FFFB_8034#);

   Data_And_Clock_Pins : constant Word := 2 ** 3 + 2 ** 4;
   TWI_And_PIOA        : constant Word := 2 ** 9 + 2 ** 2;
   Master_Enable       : constant Word := 2#100#;
   To_Co_Processor     : constant Word := 2 ** 16;
   At_381_kHz          : constant Word := 16#2_0F0F#;
   Completed           : constant Word := 2#001#;
   Transmit_Ready      : constant Word := 2#100#;

   Text : constant String :=
     Character'Val (16#CC#) & "Let's samba nxt arm in arm, (c)LEGO System A/S";

   procedure Await (Flag : Word) is
   begin
      while (TWI_Status and Flag) = 0 loop
         null;
      end loop;
   end Await;

   procedure Send is
   begin
      PMC_Enable := TWI_And_PIOA;
      PIO_Select_A := Data_And_Clock_Pins;
      PIO_Disable := Data_And_Clock_Pins;
      TWI_Waveform := At_381_kHz;
      TWI_Control := Master_Enable;
      TWI_Master_Mode := To_Co_Processor;
      for Letter of Text loop
         Await (Transmit_Ready);
         TWI_Transmit := Character'Pos (Letter);
      end loop;
      Await (Completed);
   end Send;

end Handshake;
