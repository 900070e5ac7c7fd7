--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The name of Ada 83 (Ada RM J.1)

with Ada.Calendar;

package Calendar renames Ada.Calendar;
