# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""C: generated from diagrams, and the headers of generated or foreign C read back."""
