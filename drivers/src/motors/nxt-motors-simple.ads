--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors of the NXT set without any regulation of their own.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

package NXT.Motors.Simple is

   type Simple_Motor is new Abstract_Motor with private;

private

   type Simple_Motor is new Abstract_Motor with null record;

end NXT.Motors.Simple;
