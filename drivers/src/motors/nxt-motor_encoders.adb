--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with NXT.Priorities;
with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;

package body NXT.Motor_Encoders is

   use type Word;

   Tachometers : constant Word :=
     Bit (Tachometer (Motor_A)) or Bit (Tachometer (Motor_B)) or Bit (Tachometer (Motor_C));

   Directions : constant Word :=
     Bit (Direction (Motor_A)) or Bit (Direction (Motor_B)) or Bit (Direction (Motor_C));

   protected Encoders with Interrupt_Priority => Priorities.Encoder_Interrupt is
      procedure Configure;
      function Current return Reading;
   private
      procedure Handle_Edges with Attach_Handler => Ada.Interrupts.Names.PIOA;
   end Encoders;

   protected body Encoders is

      procedure Configure is
         Ignored : Word;
      begin
         PMC.PMC.PMC_PCER := Bit (PIOA_Id);
         PIOA.PIO_PUDR := Tachometers or Directions;
         PIOA.PIO_IFER := Tachometers or Directions;
         PIOA.PIO_ODR := Tachometers or Directions;
         PIOA.PIO_PER := Tachometers or Directions;
         Ignored := PIOA.PIO_ISR;
         PIOA.PIO_IER := Tachometers;
         pragma Unreferenced (Ignored);
      end Configure;

      --  Changed is read, and thereby cleared, before the levels: an edge in between is handled
      --  once more and not lost.
      procedure Handle_Edges is
         Edges  : constant Word := PIOA.PIO_ISR and Tachometers;
         Levels : constant Word := PIOA.PIO_PDSR;
      begin
         for Motor in Motor_Id loop
            if Has (Edges, Bit (Tachometer (Motor))) then
               if Has (Levels, Bit (Tachometer (Motor))) /= Has (Levels, Bit (Direction (Motor)))
               then
                  Encoder_Count (Motor) := Encoder_Count (Motor) + 1;
               else
                  Encoder_Count (Motor) := Encoder_Count (Motor) - 1;
               end if;
            end if;
         end loop;
      end Handle_Edges;

      function Current return Reading is ((Encoder_Count, Ada.Real_Time.Clock));

   end Encoders;

   function Current return Reading is (Encoders.Current);

begin
   Encoders.Configure;
end NXT.Motor_Encoders;
