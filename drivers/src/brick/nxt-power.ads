--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The brick's supply: why the program was started, and ways to end it for good. NXT.Battery has
--  the voltage.

package NXT.Power is

   type Reset_Cause is (Power_On, Watchdog, Software, Reset_Pin, Brown_Out);

   function Last_Reset return Reset_Cause;
   --  Why the processor started last; after a RAM image was loaded, why the boot monitor did.

   procedure Reset_At_Brown_Out;
   --  From now on, and in every program after this one, the processor is reset and held while its
   --  supply is too low to rely on, in place of going on with it. Two bits of the flash memory keep
   --  that: the first call delays the caller by 8 ms, see NXT.Flash_Pages, later ones by nothing.

   procedure Switch_Off;
   --  Stop the motors and switch the brick off, within a few periods of the link to the
   --  co-processor. There is no way back.

   procedure Enter_Boot_Monitor;
   --  Stop the motors and let the co-processor restart the processor in its boot monitor, as with
   --  the reset button. This overwrites the beginning of the flash memory: a program in flash is
   --  gone, and the brick clicks until it gets a new one over USB.

end NXT.Power;
