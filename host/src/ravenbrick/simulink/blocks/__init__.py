# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What each type of block becomes; nothing here knows files or the order of blocks."""
