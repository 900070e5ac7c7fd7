# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The linear model of a balancing robot, with published constants and poles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ravenbrick.errors import DesignError
from ravenbrick.model import NXTWAY_GS


def test_the_open_loop_falls_over_as_published() -> None:
    """Poles 0, -241.19, -6.520 and +7.437 rad/s."""
    poles = np.sort(NXTWAY_GS.state_space().poles().real)
    assert np.allclose(poles, [-241.19, -6.520, 0.0, 7.437], atol=5e-3)


def test_a_body_without_mass_is_refused() -> None:
    """The field is named."""
    with pytest.raises(DesignError, match="body_mass must be > 0"):
        replace(NXTWAY_GS, body_mass=0.0)
