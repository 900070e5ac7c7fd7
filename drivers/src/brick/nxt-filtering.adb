--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Filtering is

   function Filtered
     (The_Filter : in out Filter; Latest_Sample : Sample_Value) return Sample_Value is
   begin
      if Latest_Sample /= The_Filter.Latest then
         The_Filter.Latest := Latest_Sample;
         The_Filter.Count := 0;
      end if;
      if The_Filter.Count < The_Filter.Max_Samples_Required then
         The_Filter.Count := The_Filter.Count + 1;
      end if;
      if The_Filter.Count = The_Filter.Max_Samples_Required then
         The_Filter.Accepted := Latest_Sample;
      end if;
      return The_Filter.Accepted;
   end Filtered;

end NXT.Filtering;
