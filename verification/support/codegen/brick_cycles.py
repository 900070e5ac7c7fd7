# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycles of generated step functions, counted instruction by instruction on the virtual brick."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ravenbrick.brick.step_cost import FIRST_WORDS
from ravenbrick.brick.step_cost import StepCost as Cost
from ravenbrick.brick.step_cost import count_steps as step_costs

from verification.support.codegen.c_build import arm_image

__all__ = ["Cost", "image_of_checks", "step_costs"]


def image_of_checks(
    folder: Path,
    names: Iterable[str],
    sources: list[str],
    extra: tuple[Path, ...] = (),
    options: tuple[str, ...] = (),
) -> Path:
    """An image for the brick's RAM that runs `<name>_check` of all models and then stands."""
    calls = "".join(f"  {name}_check();\n" for name in names)
    declared = "".join(f"extern void {name}_check(void);\n" for name in names)
    text = f"{declared}volatile int run_done;\nextern void run_all(void);\n"
    text += f"void run_all(void)\n{{\n{calls}  run_done = 1;\n  for (;;) {{\n  }}\n}}\n"
    (folder / "run_all.c").write_text(text)
    (folder / "first.c").write_text(FIRST_WORDS)
    files = ["first.c", "run_all.c", *sources]
    return arm_image(folder, "first", *files, options=("-Wno-pedantic", *options), extra=extra)
