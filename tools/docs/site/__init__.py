# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The bricks of the documentation site: what a sheet shows, built and put beside the pages."""
