# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a project's controller costs on the brick in each number format.

`python -m ravenbrick.cli.costs` in the project's folder loads its design.py and prints JSON: design
scripts are the user's code and run in a process of their own.
"""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

from ravenbrick.brick.step_cost import compile_and_count
from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.codegen.variants import NumberChoice, number_variants
from ravenbrick.control import Design
from ravenbrick.errors import DesignError, RavenbrickError
from ravenbrick.subprocesses import run_child

__all__ = ["project_costs"]


def project_costs(project: Path) -> list[dict[str, Any]]:
    """Rows by number format; raises `DesignError` with the script's last words."""
    command = [sys.executable, "-m", "ravenbrick.cli.costs"]
    done = run_child(command, cwd=project, errors_apart=True)
    if done.returncode != 0:
        last = (done.stderr.strip() or "no message").split("\n")[-1]
        raise DesignError(
            f"no costs of {project.name}/design.py: {last}", detail=done.stderr[-800:]
        )
    rows: list[dict[str, Any]] = json.loads(done.stdout)
    return rows


def _choice(script: Path) -> NumberChoice:
    """What `number_choice()` of the script says, or what its `design()` implies."""
    specification = importlib.util.spec_from_file_location("design", script)
    if specification is None or specification.loader is None:
        raise DesignError(f"{script}: there is no design script")
    module = importlib.util.module_from_spec(specification)
    sys.modules["design"] = module
    specification.loader.exec_module(module)
    if hasattr(module, "number_choice"):
        chosen = module.number_choice()
        if isinstance(chosen, NumberChoice):
            return chosen
    result = module.design() if hasattr(module, "design") else None
    if not isinstance(result, Design):
        raise DesignError(
            f"{script.name} has neither design() that returns a Design nor "
            "number_choice() that returns a NumberChoice; write one of them"
        )
    return NumberChoice.of_design(result)


def _rows(choice: NumberChoice) -> list[dict[str, Any]]:
    variants = number_variants(choice)
    costs = compile_and_count({variant.name: variant.program for variant in variants})
    return [
        {
            "form": variant.title,
            "least_cycles": costs[variant.name].least_cycles,
            "most_cycles": costs[variant.name].most_cycles,
            "size_bytes": costs[variant.name].size_bytes,
            "share": costs[variant.name].most_cycles
            / float(MASTER_CLOCK.hertz)
            / variant.program.sample_time,
            "error_bound": variant.bound,
            "unit": variant.unit,
        }
        for variant in variants
    ]


def main() -> int:
    """Print the rows of the design script in this folder."""
    try:
        rows = _rows(_choice(Path("design.py")))
    except RavenbrickError as error:
        print(error.sentence, file=sys.stderr)
        return int(error.exit_code)
    print(json.dumps(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
