--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body System.Multiprocessors is

   function Number_Of_CPUs return CPU is (1);

end System.Multiprocessors;
