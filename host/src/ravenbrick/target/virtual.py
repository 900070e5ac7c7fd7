# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The virtual brick as a target."""

from __future__ import annotations

import importlib
import json
from fractions import Fraction
from typing import Any

import numpy as np

from ravenbrick.errors import ImageFileError, ProjectFileError, ToolMissingError
from ravenbrick.target.clock import Clock
from ravenbrick.target.configuration import brick_configuration
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.target.lcd_text import FONT_SIZE, FONT_SYMBOL, lcd_text
from ravenbrick.target.protocol import Progress, no_progress
from ravenbrick.target.robot import Robot
from ravenbrick.target.scenario import Scenario
from ravenbrick.trace.recording import Picture, Recording, Signal, Stop, Thread, decode_events

__all__ = ["MASTER_CLOCK", "VirtualTarget"]

# 18.432 MHz crystal x 73 / 14 / 2 (AT91SAM7S256 with the NXT's PLL setting).
MASTER_CLOCK = Clock(Fraction(336_384_000, 7))
SLICE_MS = 500


def _module() -> Any:
    try:
        return importlib.import_module("virtual_brick")
    except ImportError:
        raise ToolMissingError(
            "the Python module 'virtual_brick' is not installed; run 'make setup'"
        ) from None


class VirtualTarget:
    """Runs images on the cycle-accurate virtual brick; `module` is for tests."""

    def __init__(self, module: Any = None) -> None:
        self._module = module if module is not None else _module()

    @property
    def name(self) -> str:
        """What to call it in messages."""
        return "virtual brick"

    def run(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        progress: Progress = no_progress,
    ) -> Recording:
        """See `Target.run`."""
        brick = self._assemble(robot, scenario, image)
        self._schedule(brick, scenario)
        self._probe(brick, robot, image)
        stop, pictures = self._play(brick, scenario, image, progress)
        return Recording(
            scenario=scenario.name,
            clock=MASTER_CLOCK,
            stop=stop,
            events=decode_events(brick.events()),
            signals=_signals(brick),
            threads=_threads(brick),
            pictures=tuple(pictures),
            digest=brick.trace_digest(),
        )

    def _assemble(self, robot: Robot, scenario: Scenario, image: ElfImage) -> Any:
        configuration = json.dumps(brick_configuration(robot, scenario, MASTER_CLOCK))
        try:
            brick = self._module.VirtualBrick(configuration, image.content)
        except self._module.ImageError as error:
            raise ImageFileError(f"{image.path}: {error}; build the image again") from None
        except self._module.ConfigurationError as error:
            raise ProjectFileError(robot.document.path, 1, "", str(error)) from None
        if Fraction(*brick.clock_hz) != MASTER_CLOCK.hertz:
            raise ToolMissingError(
                f"the module 'virtual_brick' has another clock ({brick.clock_hz}); "
                "run 'make setup' to build the one of this version"
            )
        if brick.threads_unobserved is not None:
            raise ImageFileError(
                f"{image.path}: its tasks cannot be observed ({brick.threads_unobserved}); "
                "link it with the project's run-time"
            )
        return brick

    def _schedule(self, brick: Any, scenario: Scenario) -> None:
        for index, event in enumerate(scenario.inputs):
            try:
                at = MASTER_CLOCK.cycles_of_ms(event.at_ms)
                brick.schedule_input(at, event.name, event.value)
            except self._module.InputError as error:
                raise scenario.document.error(("inputs", index), str(error)) from None

    def _probe(self, brick: Any, robot: Robot, image: ElfImage) -> None:
        for index, setpoint in enumerate(robot.setpoints):
            if setpoint.symbol not in image.symbols:
                raise robot.document.error(
                    ("setpoints", index, "symbol"),
                    f"the image {image.path.name} has no symbol '{setpoint.symbol}'; "
                    "name an exported variable of the application",
                )
            brick.add_probe(setpoint.symbol, setpoint.type)

    def _play(
        self, brick: Any, scenario: Scenario, image: ElfImage, progress: Progress
    ) -> tuple[Stop, list[Picture]]:
        instants = set(range(SLICE_MS, scenario.duration_ms, SLICE_MS))
        instants |= {scenario.duration_ms, *scenario.pictures_ms}
        pictures: list[Picture] = []
        for at_ms in sorted(instants):
            stop = brick.run_until(MASTER_CLOCK.cycles_of_ms(at_ms))
            progress(at_ms / scenario.duration_ms)
            if stop.reason != "reached":
                break
            if at_ms in scenario.pictures_ms:
                pictures.append(_picture(brick, image))
        pictures.append(_picture(brick, image))
        return Stop(stop.reason, stop.at_cycles, stop.message), pictures


def _picture(brick: Any, image: ElfImage) -> Picture:
    pixels = np.frombuffer(brick.lcd(), dtype=np.uint8).reshape(64, 100).astype(bool)
    font = image.symbols.get(FONT_SYMBOL)
    text = lcd_text(pixels, brick.read_memory(font.address, FONT_SIZE)) if font else ()
    return Picture(brick.cycles, pixels, text)


def _signals(brick: Any) -> dict[str, Signal]:
    return {
        name: Signal(np.frombuffer(cycles, "<u8"), np.frombuffer(values, "<f8"))
        for name, (cycles, values) in sorted(brick.signals().items())
    }


def _threads(brick: Any) -> tuple[Thread, ...]:
    """A thread's position is the subject of its events."""
    return tuple(
        Thread(
            thread.name or f"task at 0x{thread.address:08X}",
            thread.base_priority,
            thread.stack_size,
            thread.stack_used,
        )
        for thread in brick.threads()
    )
