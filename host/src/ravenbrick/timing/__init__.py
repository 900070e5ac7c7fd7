# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Timing of one image: execution-time bounds, response-time bounds, and both beside a run."""
