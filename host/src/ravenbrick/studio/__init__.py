# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Editing, building and running a project in the browser: files, commands, and their server."""

from __future__ import annotations
