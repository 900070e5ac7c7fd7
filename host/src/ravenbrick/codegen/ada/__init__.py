# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ada packages: generated from diagrams, and bindings of generated or foreign C."""
