# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The record of a brick's self-test: taken, compared with the virtual brick's, and explained."""
