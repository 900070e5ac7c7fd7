# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The live window: a page of this computer with signals and a slider per parameter."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from ravenbrick.errors import UsageError
from ravenbrick.live_page import page_figure, serve_figure
from ravenbrick.telemetry.monitor import Monitor
from ravenbrick.telemetry.picture import draw_signals, units_of, verbatim
from ravenbrick.telemetry.session import Session

__all__ = ["LiveFigure", "show_live"]

_SHOWN_S = 5.0
_SLIDER_HEIGHT = 0.05


class LiveFigure:
    """The figure, made anew when the program's signals or parameters are others."""

    def __init__(self, figure: Any, session: Session, tell: Callable[[str], None]) -> None:
        self._figure = figure
        self._session = session
        self._tell = tell
        self._shape: tuple[object, ...] = ()
        self._axes: list[Any] = []
        self._sliders: list[Any] = []

    def refresh(self) -> None:
        """Draw what is known now."""
        run = self._session.run
        if run is None or not self._session.described or not units_of(run):
            return
        units = units_of(run)
        shape = (*units, *self._session.parameters.values())
        if shape != self._shape:
            self._shape = shape
            self._build(len(units))
        draw_signals(self._axes, run, _SHOWN_S)
        self._figure.canvas.draw_idle()

    def _build(self, axis_count: int) -> None:
        from matplotlib.widgets import Slider

        self._figure.clear()
        bottom = 0.12 + _SLIDER_HEIGHT * len(self._session.parameters)
        grid = self._figure.add_gridspec(axis_count, 1, bottom=bottom, top=0.97, hspace=0.25)
        self._axes = [self._figure.add_subplot(grid[row]) for row in range(axis_count)]
        self._sliders = []
        for row, parameter in enumerate(self._session.parameters.values()):
            if not -math.inf < parameter.minimum < parameter.maximum < math.inf:
                continue
            value = self._session.values[parameter.index]
            place = self._figure.add_axes((0.2, 0.02 + _SLIDER_HEIGHT * row, 0.6, 0.03))
            slider = Slider(
                place,
                verbatim(f"{parameter.name} {f'({parameter.unit})' if parameter.unit else ''}"),
                parameter.minimum,
                parameter.maximum,
                valinit=value if math.isfinite(value) else parameter.minimum,
            )
            slider.on_changed(self._changed(parameter.name))
            self._sliders.append(slider)

    def _changed(self, name: str) -> Callable[[float], None]:
        def change(value: float) -> None:
            if math.isfinite(value):
                try:
                    self._session.set_parameter(name, value)
                except UsageError as error:
                    self._tell(str(error))

        return change


def show_live(
    monitor: Monitor, port: int, tell: Callable[[str], None], should_stop: Callable[[], bool]
) -> None:
    """Serve the page and poll the monitor until `should_stop`, or until interrupted."""
    figure = page_figure("Ravenbrick monitor", (10, 7))
    live = LiveFigure(figure, monitor.session, tell)

    def step() -> None:
        monitor.poll()
        live.refresh()

    serve_figure(figure, port, tell, should_stop, step)
