# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A Simulink model becomes a diagram; what has no counterpart is listed by its path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Diagram,
    Execution,
)
from ravenbrick.model.diagram import AlgebraicLoopError
from ravenbrick.simulink.assembly import Assembly
from ravenbrick.simulink.builder import ContinuousForm, identifier
from ravenbrick.simulink.file import SimulinkBlock, SimulinkSystem, read_simulink
from ravenbrick.simulink.libraries import Libraries
from ravenbrick.simulink.matlab.linear_systems import is_lti
from ravenbrick.simulink.network import Network, Site
from ravenbrick.simulink.numbers import Variables, Workspace
from ravenbrick.simulink.translation import Refusal, Translation
from ravenbrick.simulink.workspace import assignments

__all__ = [
    "Imported",
    "ModelSource",
    "Refusal",
    "Survey",
    "import_model",
    "import_simulink",
    "survey_simulink",
]

_SURVEYED_STEPS = 20
_CONTINUOUS = frozenset("Integrator SecondOrderIntegrator TransferFcn StateSpace ZeroPole".split())


def _kind(block: SimulinkBlock) -> str:
    """The type; of a linear system that the workspace has, a transfer function's."""
    return "TransferFcn" if is_lti(block.parameters.get("SourceBlock", "")) else block.kind


@dataclass(frozen=True)
class Survey:
    """How many blocks a model has, by what becomes of them.

    `open_inputs` are taken as 0, as Simulink does; `steps` are those that the whole model was
    simulated for.
    """

    blocks: int
    refusals: tuple[Refusal, ...]
    open_inputs: tuple[str, ...] = ()
    steps: int = 0

    @property
    def supported(self) -> int:
        """Blocks that are imported, or that only show or end signals."""
        return self.blocks - len(self.refusals)

    @property
    def outside(self) -> int:
        """Refused blocks that no diagram of signals has."""
        return sum(refusal.outside for refusal in self.refusals)


@dataclass(frozen=True)
class Imported:
    """A model as a diagram.

    `subsystem` is the path of what was imported if that was not the whole model; `continuous` says
    how continuous blocks became discrete, and is empty without such blocks.
    """

    diagram: Diagram
    subsystem: str
    continuous: str


def import_simulink(
    path: Path,
    sample_time: float,
    variables: Variables | None = None,
    libraries: Sequence[Path] = (),
    subsystem: str = "",
    name: str = "",
) -> Diagram:
    """The model in `path` (.slx or .mdl) as a diagram stepped every `sample_time` (s).

    Subsystems are dissolved, their paths become names; vectors and buses become single signals.
    `variables` are the workspace's numbers, before those that the model assigns when it is opened
    or started. Scalar gains, constants and limits become tunable parameters. Libraries and
    referenced models are looked for beside the model and in the folders `libraries`. Continuous
    blocks are made discrete by Tustin's method; where that closes a loop without delay, with their
    inputs held. Scopes and terminators are left out, with what only leads to them; in a model
    without an outport what its scopes show are the outputs. With `subsystem` (its path) only that
    is imported. The diagram is called `name`, else like the file or the subsystem. Raises
    `DesignError` with every block that cannot be imported.
    """
    given = Workspace(variables or {})
    source = ModelSource(path, sample_time, given, tuple(libraries), subsystem, name)
    return source.imported().diagram


def import_model(source: ModelSource) -> Imported:
    """`import_simulink` of the controller alone where the model shows which part that is.

    That is the only atomic subsystem of a model with continuous blocks around it, unless the
    source names a subsystem. The rest, the plant, is left out.
    """
    if not source.subsystem:
        source = replace(source, subsystem=atomic_subsystem(read_simulink(source.path)))
    return source.imported()


def atomic_subsystem(root: SimulinkSystem) -> str:
    """The path of the only atomic subsystem among continuous blocks; empty if there is none."""
    found: list[str] = []
    continuous = False
    waiting = [("", root)]
    while waiting:
        path, system = waiting.pop()
        for block in {block.name: block for block in system.blocks.values()}.values():
            own = f"{path}/{block.name}" if path else block.name
            continuous |= _kind(block) in _CONTINUOUS
            if block.system is None:
                continue
            if block.parameters.get("TreatAsAtomicUnit") == "on":
                found.append(own)
            else:
                waiting.append((own, block.system))
    return found[0] if continuous and len(found) == 1 else ""


@dataclass(frozen=True)
class ModelSource:
    """A model's file, and what it is read with; `name` is that of the diagram."""

    path: Path
    sample_time: float
    variables: Workspace
    libraries: tuple[Path, ...]
    subsystem: str = ""
    name: str = ""

    def network(self) -> Network:
        """All blocks of the model, or of its subsystem."""
        root = read_simulink(self.path)
        settings = root.settings
        variables = Workspace({}, guess=self.variables.guess)
        for callback in ("PreLoadFcn", "PostLoadFcn", "InitFcn"):
            assignments(settings.get(callback, ""), self.path.parent, variables)
        variables |= self.variables
        for part in self.subsystem.split("/") if self.subsystem else ():
            inner = [b.system for b in root.blocks.values() if b.name == part and b.system]
            if not inner:
                raise DesignError(f"{self.path}: there is no subsystem '{self.subsystem}'")
            root = inner[0]
        libraries = Libraries(self.path, self.libraries)
        try:
            return Network(root, self.path.stem, libraries, variables, settings)
        except (ValueError, RecursionError) as error:
            raise DesignError(f"{self.path}: {error}") from error

    def read(self, form: ContinuousForm = ContinuousForm.TUSTIN) -> Translation:
        """The nodes of all blocks."""
        return Translation(self.network(), self.sample_time, form)

    def require_whole(self, translation: Translation, purpose: str) -> None:
        """Raise `DesignError` with all refused blocks; `purpose` such as "imported"."""
        if not translation.refusals:
            return
        lines = [f"{r.path} ({r.kind}): {r.reason}" for r in translation.refusals]
        raise DesignError(
            f"{self.path}: {len(lines)} of {len(translation.network.sites)} blocks cannot be "
            f"{purpose}; replace them",
            detail="\n".join(lines),
        )

    def imported(self) -> Imported:
        """The diagram, with what became of the model; raises `DesignError`."""
        translation = self.read()
        self.require_whole(translation, "imported")
        return self.ordered(translation)

    def ordered(self, translation: Translation) -> Imported:
        """With held inputs of continuous blocks if they close a loop otherwise."""
        sites = translation.network.sites.values()
        kinds = {_kind(site.block) for site in sites if not site.commented}
        form = ContinuousForm.TUSTIN
        diagram = self.assembled(translation)
        try:
            diagram.order()
        except AlgebraicLoopError:
            if not kinds & _CONTINUOUS:
                raise
            form = ContinuousForm.HELD
            diagram = self.assembled(self.read(form))
            diagram.order()
        said = [f"continuous blocks: {form.value}"] if kinds & _CONTINUOUS else []
        if any(map(_is_continuous_pid, sites)):
            said.append("integrals of continuous PID controllers: forward Euler")
        return Imported(diagram, self.subsystem, "; ".join(said))

    def assembled(self, translation: Translation) -> Diagram:
        """The diagram; raises `DesignError` for a model without outputs."""
        translation.require_outputs(self.path)
        name = self.name or identifier(self.subsystem or self.path.stem)
        return Assembly(translation, name, self.path).diagram()


def survey_simulink(
    path: Path,
    sample_time: float = 0.01,
    libraries: Sequence[Path] = (),
    variables: Variables | None = None,
) -> Survey:
    """What of a model can be imported; variables that are not given count as 1.

    A block of a library counts once, as refused if any block inside it is.
    """
    given = Workspace(variables or {}, guess=True)
    source = ModelSource(path, sample_time, given, tuple(libraries))
    translation = source.read()
    own = [site for site in translation.network.sites.values() if not site.link]
    refusals = {}
    for refusal in translation.refusals:
        link = translation.network.sites[refusal.path].link
        if link and link not in refusals:
            kind = translation.network.sites[link].kind
            reason = f"inside it {refusal.path} ({refusal.kind}): {refusal.reason}"
            refusals[link] = Refusal(link, kind, reason, refusal.outside)
        elif not link:
            refusals[refusal.path] = refusal
    count = len(own) + sum(1 for s in translation.network.sites.values() if s.link == s.path)
    steps = 0
    if not refusals and translation.has_outputs:
        try:
            steps = _simulated(source.ordered(translation).diagram)
        except DesignError:
            steps = 0
    return Survey(count, tuple(refusals.values()), tuple(translation.open_inputs), steps)


def _simulated(diagram: Diagram) -> int:
    """Steps with inputs of 1; the outputs must be numbers."""
    execution = Execution(diagram)
    given = {slot.name: 1.0 for slot in execution.program.inputs}
    for _ in range(_SURVEYED_STEPS):
        execution.step(given)
    return _SURVEYED_STEPS


def _is_continuous_pid(site: Site) -> bool:
    own = site.block.parameters
    name = own.get("SourceBlock", "").replace("\n", " ")
    discrete = own.get("TimeDomain", "Continuous-time").startswith("Discrete")
    ends = ("/PID Controller", "/PID Controller (2DOF)")
    return name.endswith(ends) and not discrete and not site.commented
