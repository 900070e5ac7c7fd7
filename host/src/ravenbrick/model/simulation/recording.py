# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""All signals of a simulation, by path, and their plots."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import DesignError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Recording", "Signal"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Signal:
    """A signal's values at the instants `times` (s); one that is `held` keeps them in between."""

    path: str
    times: Floats
    values: Floats
    unit: str
    held: bool

    def at(self, time: float) -> float:
        """The value at an instant (s), after a jump there."""
        if self.held:
            place = int(np.searchsorted(self.times, time + 1e-12, "right")) - 1
            return float(self.values[max(place, 0)])
        last = int(np.searchsorted(self.times, time, "right"))
        if last and self.times[last - 1] == time:
            return float(self.values[last - 1])
        return float(np.interp(time, self.times, self.values))


@dataclass(frozen=True)
class Recording(Mapping[str, Signal]):
    """Signals by path, such as `vehicle/Left/Speed`; `events` are instants (s) with the block."""

    signals: Mapping[str, Signal]
    events: tuple[tuple[float, str], ...] = ()

    def __getitem__(self, path: str) -> Signal:
        """The signal at a path, or the only one that ends so; raises `DesignError`."""
        if path in self.signals:
            return self.signals[path]
        found = [one for one in self.signals if one.endswith(f"/{path}")]
        if len(found) == 1:
            return self.signals[found[0]]
        known = ", ".join(found or self.signals)
        raise DesignError(f"{'several signals are' if found else 'no signal is'} called '{path}'; "
                          f"there are: {known}")  # fmt: skip

    def __iter__(self) -> Iterator[str]:
        """The paths."""
        return iter(self.signals)

    def __len__(self) -> int:
        """The number of signals."""
        return len(self.signals)

    def matching(self, *patterns: str) -> list[Signal]:
        """Signals by path or pattern, such as `plant/*`."""
        found: dict[str, Signal] = {}
        for pattern in patterns:
            if any(letter in pattern for letter in "*?["):
                found |= {p: s for p, s in self.signals.items() if fnmatchcase(p, pattern)}
            else:
                found[self[pattern].path] = self[pattern]
        return list(found.values())

    def ranges(self, name: str) -> dict[str, str]:
        """By path in the diagram `name`: least, largest and last value, for `diagram_svg`."""
        found = {}
        for path, signal in self.signals.items():
            whole, _, own = path.partition("/")
            if whole == name and len(signal.values):
                low, high, last = signal.values.min(), signal.values.max(), signal.values[-1]
                found[own] = f"{low:.4g} to {high:.4g} {signal.unit}, at the end {last:.4g}"
        return found

    def plot(self, *patterns: str) -> Figure:
        """Signals over the time, those of one unit in one axis; events are marked below."""
        from matplotlib.figure import Figure  # slow to load

        chosen = sorted(self.matching(*patterns), key=lambda signal: signal.unit)
        if not chosen:
            raise DesignError(f"no signal matches {', '.join(patterns) or 'nothing'}")
        groups = [(unit, list(group)) for unit, group in groupby(chosen, lambda s: s.unit)]
        figure = Figure(figsize=(8.0, 0.8 + 2.4 * len(groups)), layout="constrained")
        axes = figure.subplots(len(groups), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (unit, signals) in zip(axes, groups, strict=True):
            for signal in signals:
                style = "steps-post" if signal.held else "default"
                axis.plot(signal.times, signal.values, drawstyle=style, label=signal.path)
            axis.set_ylabel(unit)
            axis.grid(alpha=0.3)
            axis.legend(fontsize="small")
        axes[-1].set_xlabel("time (s)")
        return figure
