# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Grading: rubric, submissions, sandboxed work on one, campaigns over many, reports."""

from __future__ import annotations
