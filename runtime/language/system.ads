--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Restrictions (No_Exception_Propagation);
--  An exception without a local handler reaches the last-chance handler

pragma Restrictions (No_Exception_Registration);
pragma Restrictions (No_Finalization);
pragma Restrictions (No_Implicit_Dynamic_Code);
pragma Restrictions (No_Tagged_Type_Registration);
--  No names of tagged types at run time: dispatching does not need them

pragma Profile (Ravenscar);
--  The tasking model of every unit, the run-time's own included

--  Characteristics of the target: ARM7TDMI of the AT91SAM7S256, little endian, 32 bits, no
--  floating-point unit. The layout of the private part is dictated by the compiler.

package System is
   pragma Pure;
   pragma No_Elaboration_Code_All;

   type Name is (SYSTEM_NAME_GNAT);
   System_Name : constant Name := SYSTEM_NAME_GNAT;

   Min_Int               : constant := -2 ** (Standard'Max_Integer_Size - 1);
   Max_Int               : constant := 2 ** (Standard'Max_Integer_Size - 1) - 1;
   Max_Binary_Modulus    : constant := 2 ** Standard'Max_Integer_Size;
   Max_Nonbinary_Modulus : constant := 2 ** Integer'Size - 1;
   Max_Base_Digits       : constant := Long_Long_Float'Digits;
   Max_Digits            : constant := Long_Long_Float'Digits;
   Max_Mantissa          : constant := Standard'Max_Integer_Size - 1;
   Fine_Delta            : constant := 2.0 ** (-Max_Mantissa);

   Tick : constant := 1.0 / 3_003_428.571_428;
   --  Period of the clock in seconds: 16 cycles of the 48.05 MHz master clock

   type Address is private;
   pragma Preelaborable_Initialization (Address);
   Null_Address : constant Address;

   Storage_Unit : constant := 8;
   Word_Size    : constant := 32;
   Memory_Size  : constant := 2 ** 32;

   function "<"  (Left, Right : Address) return Boolean with Import, Convention => Intrinsic;
   function "<=" (Left, Right : Address) return Boolean with Import, Convention => Intrinsic;
   function ">"  (Left, Right : Address) return Boolean with Import, Convention => Intrinsic;
   function ">=" (Left, Right : Address) return Boolean with Import, Convention => Intrinsic;
   function "="  (Left, Right : Address) return Boolean with Import, Convention => Intrinsic;

   type Bit_Order is (High_Order_First, Low_Order_First);
   Default_Bit_Order : constant Bit_Order := Low_Order_First;

   Max_Priority           : constant Positive := 30;
   Max_Interrupt_Priority : constant Positive := 38;

   subtype Any_Priority       is Integer      range 0 .. 38;
   subtype Priority           is Any_Priority range 0 .. 30;
   subtype Interrupt_Priority is Any_Priority range 31 .. 38;
   --  Interrupt_Priority'First + L is level L of the advanced interrupt controller

   Default_Priority : constant Priority := 15;

private

   type Address is mod Memory_Size;
   Null_Address : constant Address := 0;

   Always_Compatible_Rep     : constant Boolean := False;
   Atomic_Sync_Default       : constant Boolean := False;
   Backend_Divide_Checks     : constant Boolean := False;
   Backend_Overflow_Checks   : constant Boolean := True;
   Command_Line_Args         : constant Boolean := False;
   Configurable_Run_Time     : constant Boolean := True;
   Denorm                    : constant Boolean := True;
   Duration_32_Bits          : constant Boolean := False;
   Exit_Status_Supported     : constant Boolean := False;
   Frontend_Exceptions       : constant Boolean := False;
   Machine_Overflows         : constant Boolean := False;
   Machine_Rounds            : constant Boolean := True;
   Preallocated_Stacks       : constant Boolean := True;
   Signed_Zeros              : constant Boolean := True;
   Stack_Check_Default       : constant Boolean := False;
   Stack_Check_Limits        : constant Boolean := False;
   Stack_Check_Probes        : constant Boolean := False;
   Support_Aggregates        : constant Boolean := True;
   Support_Atomic_Primitives : constant Boolean := False;
   Support_Composite_Assign  : constant Boolean := True;
   Support_Composite_Compare : constant Boolean := True;
   Support_Long_Shifts       : constant Boolean := True;
   Suppress_Standard_Library : constant Boolean := True;
   Use_Ada_Main_Program_Name : constant Boolean := False;
   ZCX_By_Default            : constant Boolean := False;

end System;
