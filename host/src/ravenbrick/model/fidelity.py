# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether what runs is what was designed: a program with its numbers as held, beside the ideal."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.diagram import Diagram, DiagramError
from ravenbrick.model.flattening import with_shifts
from ravenbrick.model.linear_system import LinearSystem
from ravenbrick.model.linearisation import linear_system
from ravenbrick.model.number_format import FixedFormat
from ravenbrick.model.rates import sample_times
from ravenbrick.model.simulation.execution import Execution

__all__ = [
    "TOLERANCE",
    "BlockFidelity",
    "Fidelity",
    "as_held",
    "check_fidelity",
    "fidelity",
    "fixed_point_errors",
]

TOLERANCE = 1e-3
NOT_SEEN = (
    "rounding that gathers after run_s, or with other inputs than a step; blocks with limits or "
    "other curves; recursions over several blocks"
)
_FREQUENCIES = 60
_LASTING_S = 20.0
_SHORTEST = 100
_LEAST_RUN, _LONGEST_RUN = 2000, 40_000
_FARTHEST = 1 << 20
_GROWTH = 14.0
_INPUT = float(np.float32(0.7))
_SAME = 1e-12
_OUTPUT = re.compile(r"(_\d+)?(_held)?")


@dataclass(frozen=True)
class BlockFidelity:
    """A linear block as it runs beside its design.

    `pole_shift` is the largest move of a pole as a share of its distance from z = 1 or from 0,
    the smaller; `response_error` the largest error of a frequency response, `step_error` that of a
    step response of `steps` samples, run in its number format; both as shares of the largest value.
    """

    block: str
    block_type: str
    order: int
    pole_shift: float
    response_error: float
    step_error: float
    run_s: float
    horizon_s: float

    @property
    def worst(self) -> float:
        """The larger of both errors."""
        return max(self.response_error, self.step_error)

    def row(self) -> dict[str, Any]:
        """Plain values by name."""
        return dict(vars(self))


@dataclass(frozen=True)
class Fidelity:
    """All linear blocks with states that multiply, and the tolerance they must keep."""

    program: str
    tolerance: float
    blocks: tuple[BlockFidelity, ...]

    def failures(self) -> tuple[BlockFidelity, ...]:
        """Blocks that do not do what was designed."""
        return tuple(one for one in self.blocks if not one.worst <= self.tolerance)

    def rows(self) -> list[dict[str, Any]]:
        """Plain values of all blocks."""
        return [one.row() for one in self.blocks]

    def written(self) -> dict[str, Any]:
        """`rows` as `blocks`, and what they do not say."""
        return {"blocks": self.rows(), "not_seen": NOT_SEEN}


def fidelity(diagram: Diagram | ir.Program, tolerance: float = TOLERANCE) -> Fidelity:
    """Each linear block with states: coefficients, word lengths and order of operations as held.

    Not compared: blocks that are not linear, and those that multiply nothing, as a delay.
    """
    program = diagram.lower() if isinstance(diagram, Diagram) else diagram
    if ir.is_fixed_point(program):  # see fixed_point_errors
        return Fidelity(program.name, tolerance, ())
    found = [_compared(part) for part in _parts(program)]
    return Fidelity(program.name, tolerance, tuple(one for one in found if one is not None))


def check_fidelity(diagram: Diagram | ir.Program, tolerance: float = TOLERANCE) -> Fidelity:
    """`fidelity`, refused with the worst block's name where the tolerance is exceeded."""
    found = fidelity(diagram, tolerance)
    failures = found.failures()
    if failures:
        worst = max(failures, key=lambda one: one.worst)
        raise DesignError(
            f"block '{worst.block}' would not do what was designed: in its number format its step "
            f"response is wrong by {_share(worst.step_error)} and its frequency response by "
            f"{_share(worst.response_error)} (allowed: {_share(tolerance)}); "
            f"{_advice(worst.block_type)}"
        )
    return found


def _share(value: float) -> str:
    return f"{100 * value:.3g} %" if value < 10 else "more than its size"


def _advice(block_type: str) -> str:
    if block_type == "DiscreteTransferFunction":
        return "use transfer_function_block, which keeps the digits, or double precision"
    return "lengthen the sample time, use double precision, or split slow and fast parts"


def as_held(program: ir.Program) -> ir.Program:
    """The same program with each number as its format holds it."""

    def held(expression: ir.Expression) -> ir.Expression:
        match expression:
            case ir.Literal(value=value, data_type=form):
                return ir.Literal(float(form.scalar(value)), form)
            case _:
                return ir.rebuilt(expression, held)

    def slot(one: ir.Slot) -> ir.Slot:
        return replace(one, initial=float(one.data_type.scalar(one.initial)))

    return replace(
        program,
        parameters=tuple(map(slot, program.parameters)),
        states=tuple(map(slot, program.states)),
        statements=ir.mapped(program.statements, held),
    )


def _parts(program: ir.Program) -> list[tuple[str, ir.Program]]:
    """A program of its own for each output of a block with states, at the block's rate.

    What it reads of others are its inputs.
    """
    found = []
    times = sample_times(program)
    program = with_shifts(program)
    by_block: dict[str, list[ir.Statement]] = {}
    for statement in ir.statements(program.statements):
        by_block.setdefault(statement.block, []).append(statement)
    for block, statements in by_block.items():
        held = {f"{block}_held", f"{block}_was"}
        states = tuple(s for s in program.states if s.block == block and s.name not in held)
        kinds = {statement.block_type for statement in statements} - {"Enable", "RateCounter"}
        targets = Counter(statement.target for statement in statements)
        if not states or len(kinds) != 1 or max(targets.values()) > 1:
            continue
        read = _read(statements)
        own_names = {(s.target.kind, s.target.name) for s in statements}
        inputs = tuple(
            slot
            for name, slot in read.items()
            if slot.kind is not ir.Kind.PARAMETER and name not in own_names
        )
        for place, own in enumerate(statements, 1):
            if not _OUTPUT.fullmatch(own.target.name.removeprefix(block)):
                continue
            out = ir.Slot(ir.Kind.OUTPUT, "Out", own.target.data_type, block)
            last = ir.Statement(out, ir.Read(own.target), block, own.block_type)
            part = replace(
                program,
                sample_time=times.get(block, program.sample_time),
                inputs=inputs,
                outputs=(out,),
                states=states,
                signals=(),
                parameters=tuple(s for s in program.parameters if (s.kind, s.name) in read),
                statements=(*statements[:place], last, *statements[place:]),
            )
            found.append((next(iter(kinds)), part))
    return found


def _read(statements: Sequence[ir.Statement]) -> dict[tuple[ir.Kind, str], ir.Slot]:
    """Variables that the statements read."""
    return {
        (node.slot.kind, node.slot.name): node.slot
        for statement in statements
        for node in ir.nodes(statement.expression)
        if isinstance(node, ir.Read)
    }


def fixed_point_errors(source: ir.Program, program: ir.Program) -> dict[str, float]:
    """By linear block: the error of its frequency response with the integers' gains as held.

    As a share of the largest value nearby; rounding while it runs is bounded elsewhere.
    """
    found: dict[str, float] = {}
    for (_, wanted), (_, part) in zip(_parts(source), _parts(program), strict=True):
        block = part.outputs[0].block
        try:
            ideal = linear_system(wanted)
            real = _physical(linear_system(part), part)
        except DiagramError:
            continue
        order = [slot.name for slot in part.inputs]
        columns = [order.index(slot.name) for slot in wanted.inputs]
        if not columns:
            continue
        real = replace(real, B=real.B[:, columns], D=real.D[:, columns])
        found[block] = max(found.get(block, 0.0), _response_error(ideal, real))
    return found


def _physical(system: LinearSystem, part: ir.Program) -> LinearSystem:
    """From raw units to those that they stand for."""
    states, inputs, outputs = (
        np.array([slot.data_type.lsb for slot in slots if isinstance(slot.data_type, FixedFormat)])
        for slots in (part.states, part.inputs, part.outputs)
    )
    return LinearSystem(
        system.A * states[:, None] / states,
        system.B * states[:, None] / inputs,
        system.C * outputs[:, None] / states,
        system.D * outputs[:, None] / inputs,
        system.dt,
    )


def _compared(given: tuple[str, ir.Program]) -> BlockFidelity | None:
    kind, part = given
    held = as_held(part)
    exact = held.statements == part.statements and held.parameters == part.parameters
    if (exact and not _multiplies(part)) or not part.inputs:
        return None
    try:
        ideal, real = linear_system(part), linear_system(held)
    except DiagramError:
        return None
    poles, moved = (np.linalg.eigvals(system.A) for system in (ideal, real))
    horizon = _horizon(poles, part.sample_time)
    steps = min(horizon, _LONGEST_RUN, max(_LEAST_RUN, round(_LASTING_S / part.sample_time)))
    errors = (
        _step_error(part, (ideal, real), port, steps, horizon) for port in range(len(part.inputs))
    )
    return BlockFidelity(
        block=part.outputs[0].block,
        block_type=kind,
        order=ideal.nstates,
        pole_shift=_pole_shift(poles, moved),
        response_error=_response_error(ideal, real),
        step_error=max(errors),
        run_s=steps * part.sample_time,
        horizon_s=horizon * part.sample_time,
    )


def _multiplies(part: ir.Program) -> bool:
    return any(
        isinstance(node, ir.Binary) and node.operator == "*"
        for statement in ir.statements(part.statements)
        for node in ir.nodes(statement.expression)
    )


_Poles = npt.NDArray[Any]


def _horizon(poles: _Poles, sample_time: float) -> int:
    """Samples after which a step has shown each pole: three of its time constants.

    20 s for an integrator, or a pole too slow to tell from one; of an unstable pole only until it
    has grown a million times.
    """
    lasting = _LASTING_S / sample_time
    wanted, most = float(_SHORTEST), float(_FARTHEST)
    for size in np.abs(poles):
        if size > 1 + 1 / lasting:
            most = min(most, _GROWTH / math.log(size))
        else:
            settled = 3 / max(abs(1 - size), _SAME)
            wanted = max(wanted, settled if size < 1 and settled <= _FARTHEST else lasting)
    return math.ceil(min(wanted, most))


def _pole_shift(ideal: _Poles, real: _Poles) -> float:
    worst = 0.0
    for pole in ideal:
        shift = float(np.abs(real - pole).min())
        size = min(value for value in (abs(pole - 1), abs(pole), 1.0) if value > _SAME)
        worst = max(worst, shift / size if shift > _SAME else 0.0)
    return float(worst)


def _response(system: LinearSystem, points: _Poles) -> _Poles:
    """Shape (points, inputs). With A - 1 and z - 1, which keep the digits of slow poles."""
    slow = system.A - np.eye(system.nstates)
    rest = points[:, np.newaxis, np.newaxis] * np.eye(system.nstates) - slow
    states = np.linalg.solve(rest, np.broadcast_to(system.B, (len(points), *system.B.shape)))
    return np.asarray((system.C @ states + system.D)[:, 0, :])


def _response_error(ideal: LinearSystem, real: LinearSystem) -> float:
    """The largest difference over the largest value nearby, from 1e-4 of the sampling rate up."""
    points = np.expm1(1j * np.geomspace(math.pi * 1e-4, math.pi, _FREQUENCIES))
    try:
        wanted, found = _response(ideal, points), _response(real, points)
    except np.linalg.LinAlgError:
        return math.inf
    worst = 0.0
    for column, own in zip(wanted.T, found.T, strict=True):
        sizes = np.abs(column)
        near = np.array([sizes[max(k - 8, 0) : k + 9].max() for k in range(len(sizes))])
        if near.max() > 0:
            scale = np.maximum(near, near.max() * 1e-9)
            worst = max(worst, float(np.max(np.abs(own - column) / scale)))
    return worst


def _step_error(
    part: ir.Program, systems: tuple[LinearSystem, LinearSystem], port: int, steps: int, last: int
) -> float:
    """Step responses at one input, against the ideal one in double precision.

    As the part runs, and by its numbers as held. The step is no power of two, of which an
    integrator in binary digits would sum up many without rounding.
    """
    wanted, held = (_step_response(system, port, steps, last) for system in systems)
    states = tuple(replace(slot, initial=0.0) for slot in part.states)
    run = Execution(replace(part, states=states))
    given = [_INPUT * (index == port) for index in range(len(part.inputs))]
    found = np.array([values[0] for values in run.samples(given, steps)], dtype=np.float64)
    errors = np.concatenate([found / _INPUT - wanted[:steps], held - wanted])
    worst = float(np.abs(errors).max())
    largest = float(np.abs(wanted).max())
    return (worst / largest if largest else worst) if math.isfinite(worst) else math.inf


def _step_response(system: LinearSystem, port: int, steps: int, last: int) -> _Poles:
    """Outputs of a unit step in the first `steps` samples, then after 1, 2, 4 ... up to `last`.

    By doubling: the state after k + n samples is A^n times that after k, plus that after n.
    """
    states, moved, after = np.zeros((system.nstates, 1)), system.A, system.B[:, port]
    far = [after]
    with np.errstate(all="ignore"):
        while 2 ** (len(far) - 1) < max(steps, last):
            if states.shape[1] < steps:
                states = np.hstack([states, moved @ states + after[:, np.newaxis]])
            after = moved @ after + after
            moved = moved @ moved
            far.append(after)
        shown = np.hstack([states[:, :steps], np.transpose(far)])
        return np.asarray(system.C[0] @ shown + system.D[0, port])
