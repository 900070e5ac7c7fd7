# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Models of other tools: co-simulation units (FMU) of FMI 2 and 3, by the library FMPy."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ravenbrick.errors import RavenbrickError, RunFaultError, UsageError
from ravenbrick.installation import optional_module

__all__ = ["FmuFile", "FmuUnit"]

_STEP = 0.001  # s, where the unit proposes none


def _library(name: str) -> Any:
    return optional_module(name, "FMPy", "fmu", "an FMU")


class FmuFile:
    """What the description of an FMU says of its real inputs and outputs, and of its steps."""

    def __init__(self, path: Path) -> None:
        if not path.is_file():
            raise UsageError(f"{path}: there is no such file; name a co-simulation FMU")
        try:
            self.model = _library("fmpy").read_model_description(str(path))
        except RavenbrickError:
            raise
        except Exception as error:
            raise UsageError(f"{path}: cannot be read as an FMU: {error}") from None
        if self.model.coSimulation is None:
            raise UsageError(f"{path}: is for model exchange; export it for co-simulation")
        version = str(self.model.fmiVersion)
        if version[0] not in "23":
            raise UsageError(f"{path}: is of FMI {version}; export it for FMI 2 or 3")
        self.path = path
        self.third = version[0] == "3"
        real = "Float64" if self.third else "Real"
        own = [v for v in self.model.modelVariables if v.type == real and not v.dimensions]
        self.variables = {variable.name: variable for variable in own}
        self.inputs = tuple(v.name for v in own if v.causality == "input")
        self.outputs = tuple(v.name for v in own if v.causality == "output")

    def reference(self, name: str) -> int:
        """Of a variable. Raises `UsageError` where there is none of this name."""
        if name not in self.variables:
            inputs, outputs = (", ".join(n) or "none" for n in (self.inputs, self.outputs))
            raise UsageError(
                f"{self.path}: has no real number '{name}'; its inputs are {inputs}, its outputs "
                f"{outputs}"
            )
        return int(self.variables[name].valueReference)

    def unit(self, name: str) -> str:
        """Of measurement, or nothing."""
        variable = self.variables[name]
        return str(variable.unit or getattr(variable.declaredType, "unit", None) or "")

    @property
    def step(self) -> float:
        """The communication step that the unit proposes, in s."""
        usual = self.model.defaultExperiment
        proposed = usual.stepSize if usual is not None else None
        return float(self.model.coSimulation.fixedInternalStepSize or proposed or _STEP)

    @property
    def any_step(self) -> bool:
        """Whether steps may differ in length."""
        return bool(self.model.coSimulation.canHandleVariableCommunicationStepSize)


class FmuUnit:
    """An FMU, unpacked and initialised at the time 0, with the variables that are exchanged.

    Outputs are read after a step only, as FMI 2.0 (4.2.4) asks; `values` are set before the
    initialisation.
    """

    def __init__(
        self, file: FmuFile, inputs: Sequence[str], outputs: Sequence[str],
        values: Mapping[str, float] | None = None,
    ) -> None:  # fmt: skip
        self.path, self._third = file.path, file.third
        self._inputs = [file.reference(name) for name in inputs]
        self._outputs = [file.reference(name) for name in outputs]
        start = {file.reference(name): float(value) for name, value in (values or {}).items()}
        self._folder = tempfile.TemporaryDirectory(prefix="ravenbrick-fmu-")
        try:
            folder = _library("fmpy").extract(str(file.path), unzipdir=self._folder.name)
            self._unit = self._instance(file.model, folder, start)
        except RavenbrickError:
            raise
        except Exception as error:
            raise UsageError(f"{self.path}: cannot be started: {error}") from None

    def _instance(self, model: Any, folder: str, start: Mapping[int, float]) -> Any:
        unit = _library("fmpy").instantiate_fmu(folder, model, fmi_type="CoSimulation")
        self._write, self._read = (
            (unit.setFloat64, unit.getFloat64) if self._third else (unit.setReal, unit.getReal)
        )
        if start:
            self._write(list(start), list(start.values()))
        if self._third:
            unit.enterInitializationMode(startTime=0.0)
        else:
            unit.setupExperiment(startTime=0.0)
            unit.enterInitializationMode()
        unit.exitInitializationMode()
        return unit

    def outputs(self) -> list[float]:
        """Values of the outputs after the latest step."""
        return [float(value) for value in self._read(self._outputs)] if self._outputs else []

    def step(self, begin: float, length: float, inputs: Sequence[float]) -> list[float]:
        """The outputs after a step (s) with these inputs. Raises `RunFaultError`."""
        try:
            if self._inputs:
                self._write(self._inputs, list(inputs))
            answer = self._unit.doStep(
                currentCommunicationPoint=begin, communicationStepSize=length
            )
            found = self.outputs()
        except Exception as error:
            raise RunFaultError(f"{self.path}: failed at {begin:.6g} s: {error}") from None
        if self._third and (answer[1] or answer[2]):
            # FMI 3.0, 4.2.1: terminateSimulation, earlyReturn; events are not asked for.
            raise RunFaultError(
                f"{self.path}: terminated the simulation at {begin:.4f} s of its time"
            )
        return found

    def close(self) -> None:
        """End the unit and remove what was unpacked."""
        self._unit.terminate()
        self._unit.freeInstance()
        self._folder.cleanup()
