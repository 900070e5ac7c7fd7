# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The design that the runs are compared with, as design.py left it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError
from ravenbrick.json_values import json_values

__all__ = ["Design", "Estimator", "Response", "read_design"]

NAMES = ("continuous", "sampled")


@dataclass(frozen=True)
class Response:
    """A designed response to a unit step: s, and output per unit of set-point, shape (n,)."""

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    settling_time: float | None
    overshoot: float


@dataclass(frozen=True)
class Estimator:
    """A way to get a speed from counts, simulated in the loop: V, s, share of the set-point."""

    name: str
    quantum: float
    settling_time: float | None
    ripple: float
    control_peak_to_peak: float


@dataclass(frozen=True)
class Design:
    """Designed responses and the figures of the design, by name.

    The responses are those of the `continuous` design and of the `sampled` simulation; a controller
    without a plant, such as a diagram alone, has none. `diagram` is the controller's picture (SVG),
    empty if design.py left none.
    """

    responses: Mapping[str, Response]
    figures: Mapping[str, float]
    estimators: tuple[Estimator, ...]
    diagram: str = ""


def _response(table: Mapping[str, Any]) -> Response:
    times = np.asarray(table["time"], dtype=np.float64)
    values = np.asarray(table["value"], dtype=np.float64)
    if times.shape != values.shape or times.ndim != 1 or not times.size:
        raise ValueError("time and value differ in length")
    return Response(times, values, table["settling_time"], table["overshoot"])


def _estimator(table: Mapping[str, Any]) -> Estimator:
    return Estimator(**{field.name: table[field.name] for field in fields(Estimator)})


def read_design(path: Path) -> Design:
    """Read the design's figures; raises `DesignError`."""
    try:
        content = json_values(path.read_text("utf-8"))
        return Design(
            responses={name: _response(content[name]) for name in NAMES if name in content},
            figures=content["figures"],
            estimators=tuple(_estimator(table) for table in content.get("estimators", [])),
            diagram=str(content.get("diagram", "")),
        )
    except FileNotFoundError:
        raise DesignError(f"{path}: there is no design yet; run 'ravenbrick design'") from None
    except (OSError, ValueError, KeyError, TypeError, OverflowError) as error:
        raise DesignError(
            f"{path}: not a design ({type(error).__name__}: {error}); run 'ravenbrick design' again"
        ) from None
