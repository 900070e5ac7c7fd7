--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The queuing policy of the Jorvik run-time is another one unless it was built for this one

pragma Queuing_Policy (Priority_Queuing);

procedure Priority_Queuing is
begin
   null;
end Priority_Queuing;
