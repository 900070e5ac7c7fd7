# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Project files: `robot.toml`, scenarios with their stimuli and criteria, templates.

Knows no image and no brick.
"""
