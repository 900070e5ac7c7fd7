# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Images: built from a project, read, described; what they were built from.

Knows no brick.
"""
