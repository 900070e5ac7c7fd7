# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Records of bricks for everybody: read with all checks, and made of self-tests and recordings."""
