--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Removes noise from sampled inputs, such as buttons: a value counts once it was seen several
--  times in a row.

generic
   type Sample_Value is private;
   No_Value : Sample_Value;
package NXT.Filtering is

   type Filter (Max_Samples_Required : Positive) is limited private;
   --  How many equal samples in a row make an input.

   function Filtered
     (The_Filter : in out Filter; Latest_Sample : Sample_Value) return Sample_Value;
   --  The input after one more sample; No_Value until there was one.

private

   type Filter (Max_Samples_Required : Positive) is limited record
      Accepted : Sample_Value := No_Value;
      Latest   : Sample_Value := No_Value;
      Count    : Natural := 0;
   end record;

end NXT.Filtering;
