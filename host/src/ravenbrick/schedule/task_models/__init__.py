# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Systems that are more than independent tasks: two criticalities, servers, chains of releases."""
