# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the brick's loudspeaker played, as a WAV file."""

from __future__ import annotations

import io
import wave
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import UsageError

__all__ = ["save_sound"]

_SAMPLE_CYCLES = 1_000


def save_sound(brick: Any, path: Path) -> None:
    """Write all that was played since power-on, pauses as silence; raises UsageError.

    Mono, 16 bits, one sample for each 1,000 cycles of the master clock (48,054.857 Hz; the file
    says 48,055 Hz). The file is written whole or not at all.
    """
    content = io.BytesIO()
    with wave.open(content, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(round(MASTER_CLOCK.hertz / _SAMPLE_CYCLES))
        file.writeframes(brick.sound())
    try:
        atomic_write(path, content.getvalue())
    except OSError as error:
        raise UsageError(
            f"{path}: the sound cannot be saved ({error.strerror}); name a file in a folder that "
            "can be written"
        ) from None
