# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Subsystems, vector and bus signals become single blocks and lines; units are checked on these."""
