--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Devices;
with System;

package Places is

   Place : System.Address := Devices.Work'Address with Volatile;

end Places;
