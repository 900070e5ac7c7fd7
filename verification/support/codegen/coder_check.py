# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs a model of Embedded Coder on the virtual brick through its Ada binding and directly.

Two instances go step by step in turn through the binding; the same inputs go to the C itself, one
instance after the other. Both must give the same bits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ravenbrick.brick.step_cost import FIRST_WORDS
from ravenbrick.codegen import AdaBinding, CoderModel
from ravenbrick.codegen.ada.interface import Interface
from ravenbrick.codegen.c.header import KEPT_ROLES, CField

from verification.support.bricks.silent import silent_brick
from verification.support.codegen.c_build import ARM, ada_object, run
from verification.support.codegen.c_build import START as ORIGIN

LIMIT_CYCLES = 400_000_000
_LARGEST = 10.0


@dataclass(frozen=True)
class Comparison:
    """Compared outputs, how many of them differ, and how many values they take."""

    compared: int
    differing: int
    distinct: int


def compare_with_direct_calls(model: CoderModel, folder: Path, steps: int = 40) -> Comparison:
    """Build and run both ways."""
    return _Check(model, folder, steps).run()


class _Check:
    def __init__(self, model: CoderModel, folder: Path, steps: int) -> None:
        self._model, self._folder, self._steps = model, folder, steps
        self._interface = model.interface
        self._names = Interface(model.interface, AdaBinding("Adapted"))
        self._ports = {
            role: list(_elements(self._interface.fields[role])) for role in ("inputs", "outputs")
        }

    def run(self) -> Comparison:
        objects = [self._compiled(name, text) for name, text in self._c_files().items()]
        files = self._model.files_with_binding(AdaBinding("Adapted")) | self._harness()
        for name, text in files.items():
            (self._folder / name).write_text(text)
        objects += [
            ada_object(self._folder, f"{n}.adb", checks=False) for n in ("adapted", "harness")
        ]
        objects += [self._compile(f) for f in files if f.endswith(".c")]
        image = self._folder / "image.elf"
        link = ("-nostdlib", f"-Wl,-Ttext={ORIGIN:#x}", "-Wl,--entry=first", "-Wl,--gc-sections")
        warnings = ("-Wl,--no-warn-mismatch", "-Wl,--no-warn-rwx-segments")
        run("arm-none-eabi-gcc", *ARM, *link, *warnings, *objects, "-lm", "-lgcc", "-o", image)
        return self._result(image)

    def _result(self, image: Path) -> Comparison:
        brick = silent_brick(image)
        brick.run_until(LIMIT_CYCLES)
        assert brick.read_int("run_done", "u32") == 1, "the program did not end"
        count = 2 * self._steps * len(self._ports["outputs"])
        found = [
            np.frombuffer(bytes(brick.read_memory(brick.symbol(name)[0], 8 * count)))
            for name in ("found", "expected")
        ]
        bits = [values.view(np.uint64) for values in found]
        return Comparison(count, int((bits[0] != bits[1]).sum()), len(np.unique(bits[1])))

    def _compiled(self, name: str, text: str) -> Path:
        (self._folder / name).write_text(text)
        return self._compile(name)

    def _compile(self, name: str) -> Path:
        target = self._folder / f"{Path(name).stem}_c.o"
        run("arm-none-eabi-gcc", "-O2", *ARM, "-fno-short-enums", "-c",
            self._folder / name, "-o", target)  # fmt: skip
        return target

    def _c_files(self) -> dict[str, str]:
        for name, text in self._model.files.items():
            if name.endswith(".h"):
                (self._folder / name).write_text(text)
        (self._folder / "first.c").write_text(FIRST_WORDS)
        return {"first.c": FIRST_WORDS, "direct.c": self._direct()}

    def _values(self) -> np.ndarray:
        random = np.random.default_rng(5)
        columns = []
        for one, _ in self._ports["inputs"]:
            if "float" in one.c_type or "real" in one.c_type or one.c_type == "double":
                columns.append(random.uniform(-_LARGEST, _LARGEST, 2 * self._steps))
                continue
            top = (
                2
                if one.c_type in ("boolean_T", "bool")
                else min(2 ** (8 * one.size_bytes - 1), 1000)
            )
            low = 0 if one.c_type.startswith(("u", "b")) else -top
            columns.append(random.integers(low, top, 2 * self._steps).astype(float))
        return np.transpose(columns).astype(np.float32).astype(float)

    def _direct(self) -> str:
        """C that calls the model itself, and compares."""
        rows = ",\n".join("{" + ", ".join(f"{v!r}" for v in map(float, row)) + "}"
                          for row in self._values())  # fmt: skip
        outputs = len(self._ports["outputs"])
        place = {r: self._interface.symbols.get(r, f"own_{r}") for r in self._interface.types}
        if self._interface.reusable:
            place |= {r: f"own_{r}" for r in self._interface.types if r != "parameters"}
        sets = [f"  {place['inputs']}.{path} = ({one.c_type})in[{k}];"
                for k, (one, path) in enumerate(self._ports["inputs"])]  # fmt: skip
        gets = [f"  out[{k}] = (double){place['outputs']}.{path};"
                for k, (_, path) in enumerate(self._ports["outputs"])]  # fmt: skip
        return "\n".join([
            f'#include "{self._model.header}"',
            "extern void harness_start(int which);",
            "extern void harness_step(int which, const double *in, double *out);",
            _LIBRARY,
            f"static const double inputs[{2 * self._steps}][{len(self._ports['inputs'])}] = {{",
            rows, "};",
            f"double expected[2][{self._steps}][{outputs}], found[2][{self._steps}][{outputs}];",
            "volatile int run_done;",
            *self._instances(place),
            f"static void direct_step(const double *in, double *out)\n{{\n{chr(10).join(sets)}",
            f"  {self._call('step', place)};", *gets, "}",
            "extern void run_all(void);\nvoid run_all(void)\n{", "  int which, step;",
            "  for (which = 0; which < 2; which++) {", "    direct_start();",
            f"    for (step = 0; step < {self._steps}; step++) {{",
            "      direct_step(inputs[2 * step + which], expected[which][step]);", "    }", "  }",
            "  harness_start(0);\n  harness_start(1);",
            f"  for (step = 0; step < {self._steps}; step++) {{",
            "    for (which = 0; which < 2; which++) {",
            "      harness_step(which, inputs[2 * step + which], found[which][step]);",
            "    }", "  }", "  run_done = 1;\n  for (;;) {\n  }\n}", "",
        ])  # fmt: skip

    def _instances(self, place: dict[str, str]) -> Iterator[str]:
        interface = self._interface
        own = [r for r in interface.types if place[r].startswith("own_")]
        own = own if interface.reusable else [r for r in own if r == "parameters"]
        for role in own:
            yield f"static {interface.types[role]} {place[role]};"
        if not interface.reusable:
            for role in interface.symbols:
                if role != "model":
                    yield f"extern {interface.types[role]} {interface.symbols[role]};"
        elif "parameters" in interface.symbols:
            yield f"extern {interface.types['parameters']} {interface.symbols['parameters']};"
        yield "static void direct_start(void)\n{"
        shared = [r for r in (*KEPT_ROLES, "outputs") if r in interface.symbols]
        for role in own if interface.reusable else shared:
            if role != "parameters":
                yield f"  memset(&{place[role]}, 0, sizeof {place[role]});"
        for role, offset in interface.links.items() if interface.reusable else ():
            yield f"  ((void **)(void *)&own_model)[{offset // 4}] = &{place[role]};"
        yield f"  {self._call('initialize', place)};\n}}"

    def _call(self, word: str, place: dict[str, str]) -> str:
        entry = self._interface.entries[word]
        values = ["1" if role == "first_time" else f"&{place[role]}" for role in entry.arguments]
        return f"{entry.name}({', '.join(values)})"

    def _harness(self) -> dict[str, str]:
        """An Ada package that C can call, with two instances."""
        name = {one.name: self._names.name(one) for r in self._ports for one, _ in self._ports[r]}
        kinds = {
            one.name: self._names.c_type(one) for r in self._ports for one, _ in self._ports[r]
        }
        sets: list[str] = []
        gets: list[str] = []
        for role, lines in (("inputs", sets), ("outputs", gets)):
            for k, (one, path) in enumerate(self._ports[role]):
                index = f" ({int(path.partition('[')[2][:-1]) + 1})" if "[" in path else ""
                field, kind = f"Port.{name[one.name]}{index}", kinds[one.name]
                same = kind == "Long_Float"
                if role == "inputs":
                    lines.append(f"      {field} := {'' if same else f'{kind} '}(Given ({k}));")
                else:
                    lines.append(f"      Found ({k}) := {'' if same else 'Long_Float '}({field});")
        counts = len(sets) - 1, len(gets) - 1
        inputs = f"   type Entering is array (0 .. {counts[0]}) of Long_Float with Convention => C;"
        outputs = f"   type Leaving is array (0 .. {counts[1]}) of Long_Float with Convention => C;"
        spec = ["package Harness is", "", inputs, outputs, "",
                "   procedure Start (Which : Integer) with",
                '     Export, Convention => C, External_Name => "harness_start";', "",
                "   procedure Step",
                "     (Which : Integer; Given : Entering; Found : out Leaving) with",
                '     Export, Convention => C, External_Name => "harness_step";', "",
                "end Harness;", ""]  # fmt: skip
        uses = "with Interfaces;\n" if any("Interfaces" in kind for kind in kinds.values()) else ""
        gets = [line.replace("Port.", "Result.") for line in gets]
        body = [f"with Adapted;\n{uses}", "package body Harness is", "",
                "   Work : array (0 .. 1) of Adapted.Work_Area;", "",
                "   procedure Start (Which : Integer) is", "   begin",
                "      Adapted.Initialize (Work (Which));", "   end Start;", "",
                "   procedure Step",
                "     (Which : Integer; Given : Entering; Found : out Leaving)", "   is",
                "      Port   : Adapted.External_Inputs;",
                "      Result : Adapted.External_Outputs;", "   begin", *sets,
                "      Adapted.Step (Work (Which), Port, Result);", *gets,
                "   end Step;", "", "end Harness;", ""]  # fmt: skip
        return {"harness.ads": "\n".join(spec), "harness.adb": "\n".join(body)}


_LIBRARY = """\
#include <stddef.h>
void *memset(void *to, int value, size_t count);
void *memset(void *to, int value, size_t count)
{
  volatile unsigned char *place = to;
  while (count-- > 0U) { *place++ = (unsigned char)value; }
  return to;
}
void *memcpy(void *to, const void *from, size_t count);
void *memcpy(void *to, const void *from, size_t count)
{
  volatile unsigned char *place = to;
  const unsigned char *source = from;
  while (count-- > 0U) { *place++ = *source++; }
  return to;
}
void __aeabi_unwind_cpp_pr0(void);
void __aeabi_unwind_cpp_pr0(void) { }
"""


def _elements(fields: tuple[CField, ...]) -> Iterator[tuple[CField, str]]:
    """Each number with its path in C."""
    for one in fields:
        if one.length is None:
            yield one, one.name
        else:
            yield from ((one, f"{one.name}[{k}]") for k in range(one.length))
