# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What modelling, control and code generation need: a browser's notebook has no more."""

from __future__ import annotations

import json
import subprocess
import sys

PROGRAM = """
import json, sys
import numpy, scipy, control
known = {name.partition(".")[0] for name in sys.modules} | set(sys.stdlib_module_names)
import ravenbrick.model, ravenbrick.control, ravenbrick.codegen, ravenbrick.simulink
found = {name.partition(".")[0] for name in sys.modules} - known
print(json.dumps(sorted(found)))
"""


def test_only_numpy_scipy_and_control_are_pulled_in() -> None:
    """And what these pull in themselves; nothing of the command line or of the brick."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == ["ravenbrick"]


def test_no_other_part_of_the_package_is_pulled_in() -> None:
    """The parts for targets, traces, grading and commands stay out; errors and files that are
    written whole are everybody's."""
    program = (
        "import json, sys, ravenbrick.model, ravenbrick.control, ravenbrick.codegen\n"
        "print(json.dumps(sorted({n.split('.')[1] for n in sys.modules"
        " if n.startswith('ravenbrick.')})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    shared = {"atomic_write", "catalogue", "errors", "toml_values"}
    assert set(json.loads(done.stdout)) <= {"codegen", "control", "model", "simulink", *shared}
