# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the documentation: pages in a browser, the LCD, models of Simulink."""
