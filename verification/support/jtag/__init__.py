# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A JTAG adapter with an ARM7TDMI behind it, for OpenOCD's driver remote_bitbang."""
