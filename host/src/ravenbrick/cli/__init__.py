# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line; one module per command."""

from __future__ import annotations

from ravenbrick.cli.analyse import analyse_command
from ravenbrick.cli.app import app
from ravenbrick.cli.bind import bind_command
from ravenbrick.cli.build import build_command
from ravenbrick.cli.debug import debug_command
from ravenbrick.cli.demo import demo_command
from ravenbrick.cli.design import design_command
from ravenbrick.cli.doctor import doctor_command
from ravenbrick.cli.export import export_command
from ravenbrick.cli.grade import grade_command
from ravenbrick.cli.identify import identify_command
from ravenbrick.cli.import_model import import_command
from ravenbrick.cli.live import live_command
from ravenbrick.cli.monitor import monitor_command
from ravenbrick.cli.new import home_command, new_command
from ravenbrick.cli.report import report_command
from ravenbrick.cli.run import run_command
from ravenbrick.cli.schedule import schedule_command
from ravenbrick.cli.sweep import sweep_command
from ravenbrick.cli.upload import upload_command
from ravenbrick.cli.view import view_command
from ravenbrick.cli.wcet import wcet_command

__all__ = [
    "analyse_command",
    "bind_command",
    "build_command",
    "debug_command",
    "demo_command",
    "design_command",
    "doctor_command",
    "export_command",
    "grade_command",
    "home_command",
    "identify_command",
    "import_command",
    "live_command",
    "main",
    "monitor_command",
    "new_command",
    "report_command",
    "run_command",
    "schedule_command",
    "sweep_command",
    "upload_command",
    "view_command",
    "wcet_command",
]


def main() -> None:
    """Entry point of the program `ravenbrick`."""
    app()
