--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Local_Protected_Objects

procedure Local_Object is
   protected Object is
      procedure Touch;
   end Object;

   protected body Object is
      procedure Touch is null;
   end Object;
begin
   Object.Touch;
end Local_Object;
