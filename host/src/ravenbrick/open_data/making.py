# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The fields of a record: from a self-test, and from a recording of a motor."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import RecordError
from ravenbrick.image.elf import ElfImage
from ravenbrick.image.raw_binary import flat_image
from ravenbrick.open_data.data_record import LICENCE, UNITS, VERSION, DataRecord
from ravenbrick.self_test.record import Record, Row

__all__ = ["SELF_TEST", "Origin", "loaded_digest", "of_motor", "of_self_test", "self_test_of"]

SAMPLE_S = 0.004
TIME_DIGITS, VALUE_DIGITS = 6, 4
SELF_TEST = "self-test"


def loaded_digest(image: ElfImage) -> str:
    """SHA-256 of the bytes that are loaded, which do not depend on the folder of the build."""
    return hashlib.sha256(flat_image(image).content).hexdigest()


@dataclass(frozen=True)
class Origin:
    """Who measured what when; `altered` and `seed` are those of a virtual brick."""

    description: str
    brick: str
    program: str
    image: ElfImage
    battery: str
    by: str
    on: str
    altered: dict[str, Any] = field(default_factory=dict)
    seed: int | None = None

    def fields(self, kind: str, volts: float, motor: str | None = None) -> dict[str, Any]:
        """All fields but the measured ones."""
        brick: dict[str, Any] = {"kind": self.brick}
        if motor is not None:
            brick["motor"] = motor
        if self.altered:
            brick["altered"] = self.altered
        if self.seed is not None:
            brick["seed"] = self.seed
        return {
            "schema_version": VERSION,
            "kind": kind,
            "description": self.description,
            "brick": brick,
            "program": {"name": self.program, "sha256": loaded_digest(self.image)},
            "battery": {"kind": self.battery, "voltage_V": round(volts, 3)},
            "taken": {"by": self.by, "on": self.on},
            "licence": LICENCE,
        }


def of_self_test(record: Record, origin: Origin) -> dict[str, Any]:
    """The timing probes of a self-test. Raises `RecordError` without the battery's voltage."""
    battery = record.rows.get("battery.voltage")
    if battery is None:
        raise RecordError("the self-test has no row 'battery.voltage'; take it again")
    rows = [{"name": n, "unit": r.unit, "value": r.value} for n, r in record.rows.items()]
    skipped = [{"name": name, "reason": reason} for name, reason in record.skipped.items()]
    fields = origin.fields("timing", battery.value / 1000)
    return {**fields, "rows": rows, **({"skipped": skipped} if skipped else {})}


def self_test_of(record: DataRecord) -> Record:
    """The self-test in a record; raises `RecordError` for the record of a motor."""
    values = record.values
    if record.kind != "timing":
        raise RecordError(f"this record has the kind '{record.kind}'; a comparison needs 'timing'")
    rows = {row["name"]: Row(row["value"], row["unit"]) for row in values["rows"]}
    if "battery.voltage" not in rows:
        raise RecordError("this record has no row 'battery.voltage'; take the self-test again")
    skipped = {row["name"]: row["reason"] for row in values.get("skipped", ())}
    return Record(values["brick"]["kind"], values["program"]["sha256"], rows, skipped)


Samples = tuple[NDArray[np.float64], NDArray[np.float64]]


def _held(samples: Samples, instants: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at these instants; a sample holds until the next one."""
    times, values = samples
    return values[np.maximum(np.searchsorted(times, instants, side="right") - 1, 0)]


def _signal(name: str, times: NDArray[np.float64], values: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "name": name,
        "unit": UNITS[name],
        "time_s": np.round(times, TIME_DIGITS).tolist(),
        "value": np.round(values, VALUE_DIGITS).tolist(),
    }


def _changes(samples: Samples, begin: float, end: float) -> Samples:
    """The value at the beginning and its changes, since the beginning."""
    times = samples[0]
    inside = times[(times > begin) & (times < end)]
    instants = np.concatenate(([begin], inside))
    held = np.round(_held(samples, instants), VALUE_DIGITS)
    since = np.round(instants - begin, TIME_DIGITS)
    new = np.concatenate(([True], (np.diff(held) != 0) & (np.diff(since) > 0)))
    return since[new], held[new]


def of_motor(
    kind: str,
    voltage: Samples,
    angle: Samples,
    window: tuple[float, float],
    motor: str,
    volts: float,
    origin: Origin,
) -> dict[str, Any]:
    """A step response or an identification record: instants (s) with V and encoder counts."""
    begin, end = window
    instants = np.arange(begin, end, SAMPLE_S)
    signals = [
        _signal("voltage", *_changes(voltage, begin, end)),
        _signal("angle", instants - begin, _held(angle, instants)),
    ]
    return {**origin.fields(kind, volts, motor), "signals": signals}
