# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Ada task that runs a generated controller: devices in, one step, devices out."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from ravenbrick import __version__
from ravenbrick.codegen.ada.interface import AdaBinding, Interface
from ravenbrick.codegen.c.header import CField, ModelHeader, read_header
from ravenbrick.errors import DesignError

__all__ = ["INPUT_FORMS", "OUTPUT_FORMS", "TASK_PRIORITY", "TASK_STACK_BYTES", "control_task"]

INPUT_FORMS = {
    "motor.A.angle": "angle of a motor, degrees",
    "motor.A.speed": "its speed over the last samples, degrees per second",
    "battery": "supply voltage, V",
    "touch.1": "touch sensor, 1 while it is pressed",
    "light.1": "light sensor with its lamp, 0 to 1023, larger where it is brighter",
    "gyro.1": "gyro sensor, 0 to 1023, about 600 at rest",
    "1.5": "a number that a scenario or a debugger may change",
}
OUTPUT_FORMS = {
    "motor.A.voltage": "voltage of a motor, V; more than the battery gives is cut",
    "motor.A.duty": "duty cycle, -100 to 100",
    "seen": "only recorded",
}
TASK_PRIORITY = 2
TASK_STACK_BYTES = 2048
_FORMAT = re.compile(r"\b[su]fix\d+_En(-?\d+)\b")
_MOTOR = re.compile(r"motor\.([ABC])\.(\w+)\Z")
_SENSOR = re.compile(r"(touch|light|gyro)\.([1-4])\Z")


@dataclass
class _Body:
    """Lines of the package body, by where they stand."""

    units: set[str] = field(default_factory=lambda: {"Controller", "NXT.AVR"})
    objects: list[str] = field(default_factory=list)
    start: list[str] = field(default_factory=list)
    before: list[str] = field(default_factory=list)
    after: list[str] = field(default_factory=list)

    def declare(self, *lines: str) -> bool:
        """Declare an object unless it is declared; whether it was new."""
        if lines[0] in self.objects:
            return False
        self.objects += [*lines, ""]
        return True


def control_task(
    header: str,
    sample_time: float,
    inputs: Mapping[str, str | float],
    outputs: Mapping[str, str],
    speed_window: int = 8,
) -> dict[str, str]:
    """File text by file name: package `Tasks` with a cyclic task that calls package `Controller`.

    `header` is the text of the generated C header, `sample_time` the period in s. `inputs` says
    for each inport what it reads (`INPUT_FORMS`), `outputs` for each outport what it drives
    (`OUTPUT_FORMS`); a port that is not named is a number 0.0, or only recorded. A speed is the
    difference of the angle over `speed_window` samples. Each port is also a variable
    `controller_<port>` of the image. A port in fixed point is scaled, and an input of whole numbers
    saturates. Raises `DesignError` for a port or device that is not known, and for a period that is
    no whole number of microseconds.
    """
    model = read_header(header, "functional.h")
    period_us = round(sample_time * 1e6)
    if period_us < 1 or not math.isclose(sample_time * 1e6, period_us, rel_tol=1e-9):
        raise DesignError(
            f"the sample time {sample_time} s is no whole number of microseconds; choose another"
        )
    if speed_window < 1:
        raise DesignError(f"the speed window is {speed_window} samples; give at least 1")
    ports = Interface(model, AdaBinding("Controller"))
    body = _Body()
    for role, given in (("inputs", inputs), ("outputs", outputs)):
        _check(role, model, given)
    for one in model.fields["inputs"]:
        _input(body, ports, one, inputs.get(one.name, 0.0))
    for one in model.fields["outputs"]:
        _output(body, ports, one, outputs.get(one.name, "seen"))
    return {
        "tasks.ads": _specification(period_us),
        "tasks.adb": _text(body, period_us, speed_window),
    }


def _check(role: str, model: ModelHeader, given: Mapping[str, object]) -> None:
    known = [one.name for one in model.fields[role]]
    for name in given:
        if name not in known:
            raise DesignError(
                f"the controller has no port '{name}' among its {role}; it has {', '.join(known)}"
            )
    for one in model.fields[role]:
        if one.length is not None:
            raise DesignError(
                f"port '{one.name}' is a vector of {one.length}; give each device a port of its own"
            )


def _observed(body: _Body, ports: Interface, one: CField, start: float) -> str:
    """Declare the port's variable; its name."""
    name = f"{ports.name(one)}_Seen"
    body.objects += [
        f"   {name} : Float := {start!r} with",
        f'     Volatile, Export, Convention => C, External_Name => "controller_{one.name}";',
        "",
    ]
    return name


def _unknown(port: CField, given: object, forms: Mapping[str, str]) -> DesignError:
    known = ", ".join(f"'{form}' ({meaning})" for form, meaning in forms.items())
    return DesignError(f"port '{port.name}': '{given}' is not known; write one of {known}")


def _input(body: _Body, ports: Interface, one: CField, source: str | float) -> None:
    if isinstance(source, str):
        text = _reading(body, one, source)
        seen = _observed(body, ports, one, 0.0)
        body.before += [f"{seen} := {text};"]
    elif math.isfinite(source):
        seen = _observed(body, ports, one, float(source))
    else:
        raise _unknown(one, source, INPUT_FORMS)
    body.before += [f"Inputs.{ports.name(one)} := {_converted(body, ports, one, seen)};"]


def _converted(body: _Body, ports: Interface, one: CField, value: str) -> str:
    kind = ports.application_type(one)
    if kind == "Float":
        return value
    if one.c_type == "boolean_T":
        return f"(if {value} /= 0.0 then 1 else 0)"
    if not kind.startswith("Interfaces."):
        return f"{kind} ({value})"
    body.units.add("Interfaces")
    scale = _per_unit(one)
    least, most = (limit / scale for limit in _limits(kind))
    inside = f"Float'Max ({least!r}, Float'Min ({most!r}, {value}))"
    counts = inside if scale == 1.0 else f"{inside} * {scale!r}"
    return f"{kind} (Float'Rounding ({counts}))"


def _limits(kind: str) -> tuple[float, float]:
    """Of an integer type, as far as single precision has them: `Interfaces.Integer_16`."""
    sign, bits = kind.removeprefix("Interfaces.").split("_")
    own = int(bits) - (sign == "Integer")
    least = -(2.0**own) if sign == "Integer" else 0.0
    return least, 2.0**own - 2.0 ** max(own - 24, 0)


def _per_unit(one: CField) -> float:
    """What a port in fixed point counts for 1; its format stands behind it in the header."""
    found = _FORMAT.search(one.about)
    return math.ldexp(1.0, int(found[1])) if found else 1.0


def _reading(body: _Body, one: CField, source: str) -> str:
    """An expression of type Float that reads a device."""
    motor, sensor = _MOTOR.match(source), _SENSOR.match(source)
    if source == "battery":
        body.units.add("NXT.Battery")
        return "Float (NXT.Battery.Voltage) * 0.001"
    if motor and motor[2] in ("angle", "speed"):
        body.units.add("NXT.Motor_Encoders")
        count = f"NXT.Motor_Encoders.Encoder_Count (Motor_{motor[1]})"
        if motor[2] == "angle":
            return f"Float ({count})"
        past = f"Past_{motor[1]}"
        declared = [f"   Now_{motor[1]}   : Integer;", f"   Speed_{motor[1]} : Float := 0.0;"]
        if body.declare(f"   {past}  : Counts;", *declared):
            body.start += [f"{past} := (others => {count});"]
            body.before += [
                f"Now_{motor[1]} := {count};",
                f"Speed_{motor[1]} := Float (Now_{motor[1]} - {past} (Oldest)) * Per_Count;",
                f"{past} (Oldest) := Now_{motor[1]};",
            ]
        return f"Speed_{motor[1]}"
    if sensor and sensor[1] == "touch":
        body.units.add("NXT.Touch_Sensors")
        name = f"Touch_{sensor[2]}"
        body.declare(f"   {name} : NXT.Touch_Sensors.Touch_Sensor (Sensor_{sensor[2]});")
        return f"(if NXT.Touch_Sensors.Pressed ({name}) then 1.0 else 0.0)"
    if sensor and sensor[1] == "light":
        body.units |= {"NXT.Light_Sensors", "NXT.Light_Sensors.Ctors"}
        name = f"Light_{sensor[2]}"
        made = f"NXT.Light_Sensors.Ctors.Make (Sensor_{sensor[2]}, Floodlight_On => True)"
        body.declare(f"   {name} : NXT.Light_Sensors.Light_Sensor :=", f"     {made};")
        return f"Float (NXT.Light_Sensors.Normalized_Light_Value ({name}))"
    if sensor:
        return f"Float (NXT.AVR.Raw_Input (Sensor_{sensor[2]}))"
    raise _unknown(one, source, INPUT_FORMS)


def _output(body: _Body, ports: Interface, one: CField, target: str) -> None:
    seen = _observed(body, ports, one, 0.0)
    scale = _per_unit(one)
    shown = f"Float (Outputs.{ports.name(one)})"
    body.after += [f"{seen} := {shown};" if scale == 1.0 else f"{seen} := {shown} / {scale!r};"]
    motor = _MOTOR.match(target)
    if motor and motor[2] in ("voltage", "duty"):
        body.units.add("NXT.Motor_Controls")
        largest = "100.0"
        if motor[2] == "voltage":
            body.units.add("NXT.Battery")
            largest = "Float (NXT.Battery.Voltage) * 0.001"
        duty = f"To_Duty ({seen}, {largest})"
        body.after += [f"NXT.Motor_Controls.Drive (Motor_{motor[1]}, {duty});"]
    elif target != "seen":
        raise _unknown(one, target, OUTPUT_FORMS)


_HEAD = f"""--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Generated by ravenbrick {__version__}: do not edit. The ports' devices stand in design.py.
"""


def _specification(period_us: int) -> str:
    return f"""{_HEAD}
with System;

package Tasks is

   task Control_Task is
      pragma Priority (System.Priority'First + {TASK_PRIORITY});
      pragma Storage_Size ({TASK_STACK_BYTES});
   end Control_Task;
   --  Every {period_us} us: devices in, one step of the controller, devices out

end Tasks;
"""


def _text(body: _Body, period_us: int, speed_window: int) -> str:
    """The package body."""
    speeds = any(line.endswith(": Counts;") for line in body.objects)
    drives = any(".Drive (" in line for line in body.after)
    context = [
        "with Ada.Real_Time;  use Ada.Real_Time;",
        *(f"with {u};" for u in sorted(body.units)),
    ]
    lines = [_HEAD, *context, "", "package body Tasks is", "", "   use NXT;", ""]
    lines += [f"   Period        : constant Time_Span := Microseconds ({period_us});"]
    lines += ["   First_Release : constant Time := NXT.AVR.First_Release + Milliseconds (100);"]
    lines += ["   --  Counted from the co-processor task: inputs are fresh at each release", ""]
    if speeds:
        rate = f"1_000_000.0 / ({period_us}.0 * {speed_window}.0)"
        lines += [f"   Per_Count : constant := {rate};", "   --  (deg/s) per degree", ""]
        lines += [f"   subtype Reading_Index is Natural range 0 .. {speed_window - 1};"]
        lines += ["   type Counts is array (Reading_Index) of Integer;", ""]
        lines += ["   Oldest : Reading_Index := 0;", ""]
    if drives:
        lines += ["   function To_Duty is new NXT.Motor_Controls.To_Duty (Float);", ""]
    lines += body.objects
    lines += ["   task body Control_Task is", "      Work    : Controller.Work_Area;"]
    lines += ["      Inputs  : Controller.External_Inputs;"]
    lines += ["      Outputs : Controller.External_Outputs;"]
    lines += ["      Next_Release : Time := First_Release;", "   begin"]
    lines += ["      Controller.Initialize (Work);", "      delay until Next_Release;"]
    lines += [f"      {line}" for line in body.start]
    lines += ["      loop", *(f"         {line}" for line in body.before)]
    if speeds:
        lines += [f"         Oldest := (Oldest + 1) mod {speed_window};"]
    lines += ["         Controller.Step (Work, Inputs, Outputs);"]
    lines += [f"         {line}" for line in body.after]
    lines += ["         Next_Release := Next_Release + Period;"]
    lines += ["         delay until Next_Release;", "      end loop;"]
    return "\n".join([*lines, "   end Control_Task;", "", "end Tasks;", ""])
