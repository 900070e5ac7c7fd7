# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The real brick: found on USB, its boot monitor, upload.

Knows no virtual brick.
"""
