# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A record beside the virtual brick's run of the same image, row by row."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ravenbrick.brick.protocol import Progress, no_progress
from ravenbrick.catalogue import part_values
from ravenbrick.errors import RunFaultError
from ravenbrick.image.elf import ElfImage
from ravenbrick.self_test.fitting import Estimate, Rows, fit
from ravenbrick.self_test.parameters import INSEPARABLE, UNSEEN, Value
from ravenbrick.self_test.record import PARTS, Record
from ravenbrick.self_test.taking import Settings, from_virtual_brick
from ravenbrick.self_test.tolerances import tolerance_of

__all__ = ["ComparedRow", "Comparison", "compare", "equipment", "verdict"]

NOMINAL_VOLTS = 8.0


@dataclass(frozen=True)
class ComparedRow:
    """A row of both bricks; `tolerance` is None for a row that is only shown.

    `explained`: with the estimated parameters the virtual brick gives the measured value.
    """

    row: str
    unit: str
    measured: float
    virtual: float
    tolerance: float | None
    agrees: bool
    explained: bool


@dataclass(frozen=True)
class Comparison:
    """All rows that both bricks have, the parameters, and what could not be compared."""

    rows: list[ComparedRow]
    estimates: list[Estimate]
    missing: Mapping[str, str]

    @property
    def timing(self) -> dict[str, Value]:
        """The moved parameters, as the configuration's field `timing` takes them."""
        return {e.parameter.name: e.value for e in self.estimates if e.moved}

    @property
    def unexplained(self) -> list[str]:
        """Rows that differ whatever the parameters."""
        return [row.row for row in self.rows if not row.agrees and not row.explained]

    def data(self) -> dict[str, Any]:
        """What `--json` prints."""
        return {
            "rows": [asdict(row) for row in self.rows],
            "parameters": [
                {"name": e.parameter.name, "virtual": e.parameter.nominal}
                | {"measured": list(e.values), "verdict": verdict(e)}
                for e in self.estimates
            ],
            "timing": self.timing,
            "unexplained": self.unexplained,
            "not_measured": dict(self.missing),
            "not_seen": {**UNSEEN, **INSEPARABLE},
        }


def verdict(estimate: Estimate) -> str:
    """One word for a parameter."""
    if not estimate.fits:
        return "unexplained"
    if estimate.moved:
        return "moved"
    return "confirmed" if len(estimate.values) == 1 else "possible"


def equipment(record: Record | None = None) -> dict[str, Any]:
    """The virtual brick with what the record's brick had; without a record with a motor and
    a touch sensor.
    """
    rows = record.rows if record else {"motor.A.forwards": None, "touch.pressed": None}
    motor = {"parameters": part_values("motors", "nxt")}
    volts = record.rows["battery.voltage"].value / 1000 if record else NOMINAL_VOLTS
    return {
        "battery": {"kind": "li_ion", "voltage": volts, "internal_resistance": 0.0},
        "motors": {m: motor for m in "ABC" if f"motor.{m}.forwards" in rows},
        "sensors": {"1": {"kind": "touch"}} if "touch.pressed" in rows else {},
    }


def _compared(measured: Rows, nominal: Rows, estimated: Rows) -> list[ComparedRow]:
    compared = []
    for name, row in measured.items():
        if name not in nominal:
            continue
        virtual, tolerance = nominal[name].value, tolerance_of(name)
        agrees = tolerance is None or tolerance.allows(row.value, virtual)
        explained = tolerance is not None and (
            name in estimated and tolerance.allows(row.value, estimated[name].value)
        )
        width = tolerance.of(virtual) if tolerance else None
        compared.append(ComparedRow(name, row.unit, row.value, virtual, width, agrees, explained))
    return compared


def compare(record: Record, image: ElfImage, progress: Progress = no_progress) -> Comparison:
    """Run the record's image on the virtual brick and find the parameters that fit.

    Raises `RunFaultError` when the image does not run there.
    """
    present: Settings = equipment(record)

    def timing_rows(values: Mapping[str, Value]) -> Rows | None:
        try:
            return from_virtual_brick(image, {**present, "timing": dict(values)}, PARTS[0]).rows
        except RunFaultError:
            return None

    nominal = from_virtual_brick(image, present)
    estimates = fit(record.rows, timing_rows, progress)
    timing = {e.parameter.name: e.value for e in estimates if e.moved}
    estimated = nominal
    if timing:
        estimated = from_virtual_brick(image, {**present, "timing": timing})
    missing = dict(record.skipped)
    missing |= {name: "not in the record" for name in nominal.rows if name not in record.rows}
    rows = _compared(record.rows, nominal.rows, estimated.rows)
    return Comparison(rows, estimates, missing)
