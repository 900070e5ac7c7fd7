# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The virtual brick: configured from a project, run, watched live, saved and restored."""
