--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Devices.Kinds is

   procedure Start (This : in out Short) is
   begin
      Work (2);
   end Start;

   package body Nested is
      procedure Start (This : in out Long) is
      begin
         Work (40);
      end Start;
   end Nested;

   procedure Read (This : in out Slow) is
   begin
      Work (60);
   end Read;

   procedure Read (This : in out Lamp) is
   begin
      Work (3);
   end Read;

   procedure Send (This : in out Lamp) is
   begin
      This.Uses := Natural'Min (This.Uses, 9) + 1;
      Work (30);
   end Send;

end Devices.Kinds;
