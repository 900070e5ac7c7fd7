# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The one interface behind which a brick runs an image."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import Scenario
from ravenbrick.trace.recording import Recording

__all__ = ["Progress", "Target", "no_progress"]

Progress = Callable[[float], None]


def no_progress(_share: float) -> None:
    """Ignore the share (0 to 1) of the run that is done."""


class Target(Protocol):
    """A brick that can be loaded and run."""

    @property
    def name(self) -> str:
        """What to call it in messages."""

    def run(
        self,
        robot: Robot,
        scenario: Scenario,
        image: ElfImage,
        progress: Progress = no_progress,
    ) -> Recording:
        """Load the image, play the scenario, and return what was recorded.

        A fault or halt of the program is in the recording's `stop`; raises `ToolMissingError`,
        `ImageFileError` or `ProjectFileError` when it does not come to a run.
        """
