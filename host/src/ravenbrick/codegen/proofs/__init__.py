# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Error bounds of fixed-point code and their independent checks by Frama-C and Gappa."""
