--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Journal; use Journal;

package body Queue is

   protected body Gate is
      entry Pass when Open is
      begin
         Open := False;
      end Pass;
   end Gate;

   task body One is
   begin
      Note ('1');
      Gate.Pass;
      Note ('x');
   end One;

   task body Two is
   begin
      Note ('2');
      Gate.Pass;
      Note ('y');
   end Two;

end Queue;
