# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Links between a running virtual brick and other programs: ports, sockets, other bricks."""
