# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The proof that goes with fixed-point C: formats, ranges, and bounds of the rounding error."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ravenbrick import __version__
from ravenbrick.codegen.c.generator import GeneratedCode, generate_c
from ravenbrick.codegen.proofs.frama_c import frama_c_goals
from ravenbrick.codegen.proofs.gappa import NO_GOAL, gappa_script
from ravenbrick.errors import DesignError
from ravenbrick.model.fixed_point import FixedPoint
from ravenbrick.model.number_format import FixedFormat
from ravenbrick.model.program import Slot

if TYPE_CHECKING:
    from ravenbrick.control.rounding.ideal_error import IdealBound
    from ravenbrick.control.rounding.limit_cycles import LimitCycleSearch
    from ravenbrick.control.rounding.rounding_error import ClosedLoopBound, PlantInLoop

__all__ = ["FixedPointProof", "generate_fixed_c", "prove"]


@dataclass(frozen=True, eq=False)
class FixedPointProof:
    """What is proved of a fixed-point program; `closed_loop` only with a plant.

    `all_time` bounds the outputs without a plant, by outport, if there is such a bound; else
    `why_not` says why. `limit_cycles` is what was found of oscillations, if they were looked for.
    """

    fixed: FixedPoint
    one_step: dict[str, float]
    closed_loop: ClosedLoopBound | None
    limit_cycles: LimitCycleSearch | None = None
    all_time: Mapping[str, IdealBound] | None = None
    why_not: str = ""

    def results(self) -> dict[str, Any]:
        """Plain values for JSON; SI units and V."""
        program = self.fixed.program
        return {
            "model": program.name,
            "sample_time": program.sample_time,
            "rounding": self.fixed.options.rounding.value,
            "variables": [self._variable(slot) for slot in self._slots()],
            "gains": [self._gain(slot) for slot in program.parameters],
            "overflow": "none for any value of the inputs' formats, by induction over the steps",
            "one_step_error": self.one_step,
            "all_time_error": self._all_time(),
            "closed_loop": self._loop(),
            "limit_cycles": self._cycles(),
        }

    def _all_time(self) -> dict[str, Any] | str:
        if self.all_time is None:
            return f"not stated: {self.why_not}"
        return {
            name: {"rounding": one.rounding, "coefficients": one.coefficients, "bound": one.total}
            for name, one in self.all_time.items()
        }

    def _cycles(self) -> dict[str, Any] | None:
        found = self.limit_cycles
        if found is None:
            return None
        return {
            "runs": found.runs,
            "steps": found.steps,
            "closed_loop": found.closed_loop,
            "oscillating": len(found.cycles),
            "largest_peak_to_peak_lsb": found.largest_lsb,
            "periods_samples": sorted({cycle.period for cycle in found.cycles}),
        }

    def _slots(self) -> tuple[Slot, ...]:
        """Variables that hold numbers; the state of a machine is none."""
        program = self.fixed.program
        found = program.inputs + program.outputs + program.states + program.signals
        return tuple(slot for slot in found if isinstance(slot.data_type, FixedFormat))

    def _variable(self, slot: Slot) -> dict[str, Any]:
        form = slot.data_type
        assert isinstance(form, FixedFormat)
        raw = self.fixed.raw_ranges[slot.kind, slot.name]
        return {
            "name": slot.name,
            "kind": slot.kind.value,
            "format": str(form),
            "lowest": form.real(int(raw.low)),
            "highest": form.real(int(raw.high)),
        }

    def _gain(self, slot: Slot) -> dict[str, Any]:
        form = slot.data_type
        assert isinstance(form, FixedFormat)
        real = {s.name: s.initial for s in self.fixed.source.parameters}[slot.name]
        held = form.real(int(slot.initial))
        return {
            "name": slot.name,
            "format": str(form),
            "raw": int(slot.initial),
            "wanted": real,
            "held": held,
            "error": held - real,
        }

    def _loop(self) -> dict[str, Any] | None:
        bound = self.closed_loop
        if bound is None:
            return None
        rows = zip(bound.sources, bound.peak_gains, bound.shares, strict=True)
        return {
            "unit": bound.unit,
            "bound": bound.total,
            "coefficients": bound.coefficients,
            "sources": [
                {
                    "block": source.block,
                    "rounded": source.what,
                    "lsb": source.lsb,
                    "largest_error_lsb": source.size if source.active else 0.0,
                    "peak_gain": gain,
                    "share": share,
                }
                for source, gain, share in rows
            ],
        }

    def text(self) -> str:
        """The same for reading."""
        results = self.results()
        lines = [
            f"Fixed-point proof of '{results['model']}', sample time "
            f"{results['sample_time'] * 1000:g} ms, rounding {results['rounding']}",
            "",
            "Range of each variable for any inputs of their formats and any number of steps:",
        ]
        for row in results["variables"]:
            lines.append(
                f"  {row['kind']:8} {row['name']:24} {row['format']:14} "
                f"{row['lowest']:14.6g} to {row['highest']:.6g}"
            )
        lines += ["No result exceeds its format or 32 bits.", "", "Gains as held:"]
        for row in results["gains"]:
            lines.append(
                f"  {row['name']:24} {row['format']:14} {row['raw']:12d} = {row['held']:.9g} "
                f"(wanted {row['wanted']:.9g}, error {row['error']:+.3g})"
            )
        lines += ["", "One step against real numbers, inputs and states in their ranges:"]
        lines += [f"  |error of {name}| <= {e:.6g}" for name, e in self.one_step.items()]
        lines += [
            f"  {slot.name}: not stated, a block before it decides or rounds"
            for slot in self.fixed.program.outputs
            if slot.name not in self.one_step
        ]
        lines += [] if self.one_step else [f"  {NO_GOAL}"]
        cycles = (
            []
            if self.limit_cycles is None
            else ["", "Limit cycles (a search, no proof):", f"  {self.limit_cycles.sentence()}"]
        )
        return "\n".join([*lines, *self._all_time_text(), *self._loop_text(), *cycles, ""])

    def _all_time_text(self) -> list[str]:
        head = ["", "For all time against the design in real numbers, without a plant:"]
        if self.all_time is None:
            return [*head, f"  not stated: {self.why_not}"]
        return [
            *head,
            *(
                f"  |error of {name}| <= {one.total:.6g} (rounding {one.rounding:.6g}, "
                f"numbers as held {one.coefficients:.6g})"
                for name, one in self.all_time.items()
            ),
        ]

    def _loop_text(self) -> list[str]:
        loop = self._loop()
        if loop is None:
            return ["", "In the loop: no plant was given, so no bound for all time is stated."]
        lines = ["", "In the loop with the plant, for all time while no limit is reached:"]
        for row in loop["sources"]:
            what = "a rounded state would count" if row["rounded"] == "state" else row["rounded"]
            lines.append(
                f"  {row['block']:24} {what:28} peak gain {row['peak_gain']:8.4g}, "
                f"error <= {row['largest_error_lsb']:g} LSB of {row['lsb']:.6g}: {row['share']:.6g}"
            )
        lines.append(f"  numbers as held, inputs in their ranges: {loop['coefficients']:.6g}")
        return [*lines, f"  |error of the observed signal| <= {loop['bound']:.6g} {loop['unit']}"]


def prove(
    fixed: FixedPoint, plant: PlantInLoop | None = None, *, limit_cycles: bool = False
) -> FixedPointProof:
    """Bounds of the errors in one step, for all time, and with a plant in the loop.

    The ranges were proved when the formats were chosen. With `limit_cycles` oscillations are
    looked for besides, in the loop if there is a plant.
    """
    from ravenbrick.control.rounding.ideal_error import ideal_bounds  # slow to load
    from ravenbrick.control.rounding.limit_cycles import search_limit_cycles
    from ravenbrick.control.rounding.rounding_error import closed_loop_bound, one_step_errors

    loop = None if plant is None else closed_loop_bound(fixed, plant)
    found = search_limit_cycles(fixed, plant) if limit_cycles else None
    try:
        bounds, reason = ideal_bounds(fixed), ""
    except DesignError as error:
        bounds, reason = None, error.sentence
    return FixedPointProof(fixed, one_step_errors(fixed), loop, found, bounds, reason)


def generate_fixed_c(
    fixed: FixedPoint,
    plant: PlantInLoop | None = None,
    *,
    only_used: bool = False,
    tunable: bool = True,
) -> GeneratedCode:
    """The integer C with its proof: `<model>_proof.json`, `<model>_proof.txt`, `<model>.gappa`

    if an outport has a bound for the error of one step, and `<model>_goals.h`, contract and driver
    for Frama-C (`check_with_frama_c`).

    `only_used` and `tunable` as in `generate_c`. The proof holds for the parameters' values as
    they are: without `tunable` nobody can set others.
    """
    code = generate_c(fixed.program, only_used=only_used, tunable=tunable)
    proof = prove(fixed, plant, limit_cycles=True)
    name = fixed.program.name
    record = {
        "generator": f"ravenbrick {__version__}",
        "input_digest": code.digest,
        "source_digest": hashlib.sha256(repr(fixed.source).encode()).hexdigest(),
        **proof.results(),
    }
    files = {
        **code.files,
        f"{name}_proof.json": json.dumps(record, indent=1) + "\n",
        f"{name}_proof.txt": proof.text(),
        f"{name}_goals.h": frama_c_goals(fixed, tunable=tunable),
    }
    if proof.one_step:
        files[f"{name}.gappa"] = gappa_script(fixed, proof.one_step)
    absent = () if proof.one_step else (f"{name}.gappa",)
    return GeneratedCode(files, code.digest, absent)
