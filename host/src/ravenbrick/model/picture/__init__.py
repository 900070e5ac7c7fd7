# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of diagrams: layers from left to right, orthogonal lines, as SVG."""
