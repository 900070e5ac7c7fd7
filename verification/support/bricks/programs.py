# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Builds Ada programs for tests and measurements, as a project of a user's own is built."""

from __future__ import annotations

import os
import subprocess
from functools import cache
from pathlib import Path

from verification.support.paths import ROOT

__all__ = ["CONFIGURATION", "gprbuild"]

CONFIGURATION = ROOT / "tools" / "ravenbrick.cgpr"
# With it only what has changed is compiled again, as it says; `-s` counts switches, too.
RUN_TIME = ROOT / "tools" / "run_time.gpr"


@cache
def make_run_time() -> None:
    """The run-time of the Ravenscar profile; RAVENBRICK_RTS names another one, taken as it is."""
    if "RAVENBRICK_RTS" not in os.environ:
        subprocess.run(["make", "--silent", "-C", ROOT / "runtime"], check=True)


def gprbuild(
    project: Path, *options: str, run_time: Path | None = None, **variables: object
) -> None:
    """Build a project with the run-time in this folder, the default one unless given.

    `options` are gprbuild's; `variables` are the external variables of the project (-X). Raises
    `subprocess.CalledProcessError` after gprbuild has said why.
    """
    if run_time is None:
        make_run_time()
    environment = os.environ | {"LC_ALL": "C"}
    if run_time is not None:
        environment["RAVENBRICK_RTS"] = str(run_time)
    if "RAVENBRICK_RTS" in environment:
        variables["RUN_TIME"] = environment["RAVENBRICK_RTS"]
    values = [f"-X{name}={value}" for name, value in variables.items()]
    configured = (f"--config={CONFIGURATION}", f"--implicit-with={RUN_TIME}")
    command = ["gprbuild", "-q", "-s", "-j2", *configured, "-P", str(project), *values, *options]
    subprocess.run(command, check=True, env=environment)
