# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing: do a room's own tests notice a small change of its sources?"""
