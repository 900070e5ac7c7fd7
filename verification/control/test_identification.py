# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The campaign of hidden motors, for two motors."""

from __future__ import annotations

import pytest

from verification.control.identification import IMAGE, campaign


@pytest.mark.skipif(not IMAGE.is_file(), reason="'ravenbrick build examples/vehicle' builds it")
def test_hidden_parameters_are_found() -> None:
    """Two motors with constants of their own; at most one interval misses."""
    total = campaign(2)
    assert set(total) == {"gain", "time_constant", "friction_voltage"}
    assert sum(total.values()) >= 5
