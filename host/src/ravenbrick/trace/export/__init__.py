# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings in the file formats of other tools; one module per format.

The same recording gives the same bytes: no file holds the time or place of its making.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from tempfile import TemporaryDirectory

from ravenbrick.trace.export.mcap_file import write_mcap
from ravenbrick.trace.export.perfetto_file import write_perfetto
from ravenbrick.trace.export.tables import write_csv, write_parquet
from ravenbrick.trace.export.timeline import timeline_of
from ravenbrick.trace.export.vcd_file import write_vcd
from ravenbrick.trace.recording import Recording

__all__ = ["Format", "export"]


class Format(Enum):
    """A file format."""

    PERFETTO = "perfetto"
    VCD = "vcd"
    MCAP = "mcap"
    CSV = "csv"
    PARQUET = "parquet"

    @property
    def suffix(self) -> str:
        """What its files' names end with."""
        return ".pftrace" if self is Format.PERFETTO else f".{self.value}"


_WRITERS = {
    Format.PERFETTO: write_perfetto,
    Format.VCD: write_vcd,
    Format.MCAP: write_mcap,
    Format.CSV: write_csv,
    Format.PARQUET: write_parquet,
}


def export(recording: Recording, file_format: Format, path: Path) -> Sequence[Path]:
    """Write a recording, all files or none, and return them.

    Raises `ToolMissingError` without the format's library, `OSError` that names the file.
    """
    timeline, write = timeline_of(recording), _WRITERS[file_format]
    path = path.resolve()
    try:
        if path.exists() and not path.is_file():
            return write(timeline, path)
        path.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=".export-", dir=path.parent) as folder:
            files = write(timeline, Path(folder) / path.name)
            return [file.replace(path.parent / file.name) for file in files]
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(path)) from None
