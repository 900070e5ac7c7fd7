--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;
with System.Storage_Elements;

package body Ravenbrick.Interrupts is

   use Interfaces;
   use type System.Address;
   use Ravenbrick.Registers;
   use Ravenbrick.Threads;

   type Handler is record
      Object          : System.Address;
      Code            : System.Address;
      Active          : aliased Urgency;
      Secondary_Stack : System.Address;
   end record
     with Convention => C;
   --  A vector of the controller is the address of one of these records' Active. There it looks
   --  like the beginning of a thread, and is the current one while the handler is executed. The
   --  interrupt entry in arm7tdmi/ uses the layout.

   Spurious : constant := 32;
   --  In place of a source

   type Handler_Index is range 0 .. Spurious;

   type Handler_Table is array (Handler_Index) of aliased Handler;

   Handlers : Handler_Table
     with Export, Convention => C, External_Name => "ravenbrick__interrupts__handlers";
   --  Found by arm7tdmi/charge.h and by tools that look for handlers

   procedure Ignore (Unused : System.Address) with Convention => C;

   type Set_Table is array (System.Interrupt_Priority) of Word;

   At_Or_Below : Set_Table := (others => 0);
   --  Attached sources by priority

   Attached : Word := 0;

   Masked : Urgency := -1 with Volatile;
   --  Sources up to this urgency are disabled, or about to be: written before the controller is,
   --  so that a handler which raises and lowers the mask in between does not undo it

   function To_Priority (Active : Urgency) return System.Interrupt_Priority is
     (System.Interrupt_Priority (Active / 2)) with Inline_Always;

   function Address_Of (Item : System.Address) return Word is
     (Word (System.Storage_Elements.To_Integer (Item)));

   procedure Ignore (Unused : System.Address) is null;

   procedure Initialize is
      None : constant Word := Address_Of (Handlers (Spurious).Active'Address);
   begin
      Handlers (Spurious).Code := Ignore'Address;
      Handlers (Spurious).Active := To_Protected_Urgency (System.Interrupt_Priority'Last);
      AIC.AIC_IDCR := Word'Last;
      AIC.AIC_ICCR := Word'Last;
      AIC.AIC_DCR := Protect_Mode;
      AIC.AIC_SPU := None;
      for Source in Source_Id loop
         AIC.AIC_SVR (Source) := None;
         if Source <= 7 then
            AIC.AIC_EOICR := 0;
         end if;
      end loop;
   end Initialize;

   procedure Attach
     (Source   : Source_Id;
      Priority : System.Interrupt_Priority;
      Code     : System.Address;
      Object   : System.Address)
   is
      Bit   : constant Word := Shift_Left (1, Natural (Source));
      Taken : Handler renames Handlers (Handler_Index (Source));
      Level : constant Word := Word (Priority - System.Interrupt_Priority'First);
   begin
      Taken.Object := Object;
      Taken.Code := Code;
      Taken.Active := To_Protected_Urgency (Priority);
      AIC.AIC_IDCR := Bit;
      AIC.AIC_SMR (Source) := Level;
      AIC.AIC_SVR (Source) := Address_Of (Taken.Active'Address);
      AIC.AIC_ICCR := Bit;
      for Other in Priority .. System.Interrupt_Priority'Last loop
         At_Or_Below (Other) := At_Or_Below (Other) or Bit;
      end loop;
      Attached := Attached or Bit;
      AIC.AIC_IECR := Bit;
   end Attach;

   function Is_Attached (Source : Source_Id) return Boolean is
     ((Attached and Shift_Left (1, Natural (Source))) /= 0);

   function Source_Of (Current : System.Address) return Integer is
   begin
      for Source in Source_Id loop
         if Handlers (Handler_Index (Source)).Active'Address = Current then
            return Integer (Source);
         end if;
      end loop;
      return -1;
   end Source_Of;

   procedure Raise_Mask (Ceiling : Urgency; Saved : out Urgency) is
   begin
      Saved := Masked;
      Masked := Ceiling;
      AIC.AIC_IDCR := At_Or_Below (To_Priority (Ceiling));
   end Raise_Mask;

   procedure Lower_Mask (Ceiling, Saved : Urgency) is
      Still : constant Word :=
        (if Saved < First_Interrupt_Urgency then 0 else At_Or_Below (To_Priority (Saved)));
   begin
      Masked := Saved;
      AIC.AIC_IECR := At_Or_Below (To_Priority (Ceiling)) and not Still;
   end Lower_Mask;

end Ravenbrick.Interrupts;
