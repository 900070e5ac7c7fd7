# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing of the virtual brick's inputs (docs/reference/fuzzing.md)."""
