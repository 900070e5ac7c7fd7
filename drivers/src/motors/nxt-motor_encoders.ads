--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Angles of the motors: one count per degree of the output shaft, positive forward. The
--  tachometer line changes 360 times per turn; its level against the direction line at each
--  change gives the sign (NXT Hardware Developer Kit, motor).

with Ada.Real_Time;

package NXT.Motor_Encoders with Elaborate_Body is

   type Encoder_Counts is array (Motor_Id) of Integer with Atomic_Components;

   type Reading is record
      Counts  : Encoder_Counts;
      Instant : Ada.Real_Time.Time;
   end record;

   function Current return Reading;
   --  Recommended: the counts of all motors at one instant, with that instant; no edge falls
   --  between them.

   Encoder_Count : Encoder_Counts := (others => 0);
   --  As known from GNAT for MINDSTORMS: degrees turned since the start of the program, or since
   --  the program set a count to another value.

end NXT.Motor_Encoders;
