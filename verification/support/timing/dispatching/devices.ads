--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Roots of the hierarchies. The first operation of each type stands in the same place of its
--  dispatch table.

package Devices is

   Work_Done : Natural := 0 with Volatile;

   procedure Work (Steps : Positive) with No_Inline;
   --  Takes longer with more steps

   type Device is abstract tagged limited record
      Uses : Natural := 0;
   end record;
   procedure Start (This : in out Device) is abstract;
   procedure Rest (This : in out Device) is null;

   type Any_Device is access all Device'Class;

   type Meter is abstract tagged limited record
      Uses : Natural := 0;
   end record;
   procedure Read (This : in out Meter) is abstract;

   type Any_Meter is access all Meter'Class;

   type Signal is limited interface;
   procedure Send (This : in out Signal) is abstract;

   type Any_Signal is access all Signal'Class;

   procedure Run (This : in out Device'Class) with No_Inline;
   --  Sees none of the types below

end Devices;
