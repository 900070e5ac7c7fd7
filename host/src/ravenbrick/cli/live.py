# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick live`: the virtual brick in real time, Bluetooth or USB on a port of the computer."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.brick.links.byte_ports import open_port
from ravenbrick.brick.links.live import LiveRecord, LiveRun, replay_live
from ravenbrick.brick.links.usbip import UsbIpServer
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.cli.app import JsonOption, ProjectArgument, command
from ravenbrick.cli.build import ImageChoice, ImageOption
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.pipeline import project_image
from ravenbrick.errors import InterruptError, RunFaultError, UsageError
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario, scenario_path
from ravenbrick.project.workspace import Workspace

__all__ = ["live_command"]


@command("ravenbrick live examples/motor-bench step --bluetooth tcp:5555")
def live_command(
    directory: ProjectArgument,
    scenario: Annotated[str, typer.Argument(help="Scenario that provides environment and inputs.")],
    bluetooth: Annotated[
        str, typer.Option(help="Bluetooth port: tcp:PORT on 127.0.0.1 (0: any free port), or pty.")
    ] = "tcp:5555",
    usb: Annotated[
        str | None, typer.Option(help="USB port in place of Bluetooth: tcp:PORT or pty.")
    ] = None,
    usb_ip: Annotated[
        int | None, typer.Option(min=0, max=65_535, help="USB/IP server's TCP port (0: any).")
    ] = None,
    pin: Annotated[str, typer.Option(help="Bluetooth PIN of the program.")] = "1234",
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="Virtual seconds (default: until Ctrl-C).")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.0, help="Virtual seconds per real second (0: no limit).")
    ] = 1.0,
    record: Annotated[
        Path | None, typer.Option(help="File for the external inputs, for a later --replay.")
    ] = None,
    replay: Annotated[
        Path | None, typer.Option(help="File of --record to replay; both runs are compared.")
    ] = None,
    image: ImageOption = ImageChoice.RAM,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    workspace, robot = Workspace.of(directory), read_robot(directory)
    chosen = read_scenario(scenario_path(directory, scenario), robot)
    reporter = Reporter(json_output)
    loaded = project_image(workspace, robot, image.kind, reporter)
    brick = VirtualTarget().prepare(robot, chosen, loaded)
    if replay is not None:
        kept = LiveRecord.load(replay)
        if kept.scenario != chosen.name:
            raise UsageError(f"{replay}: is of the scenario '{kept.scenario}'; name that scenario")
        return _replayed(brick, kept, reporter)
    port, run_record = open_port(usb or bluetooth), LiveRecord(chosen.name)
    link = "USB" if usb else "Bluetooth"
    reporter.tell(f"{link} of '{robot.name}' on {port.address}; Ctrl-C ends; listen with")
    reporter.tell(f"  ravenbrick monitor {port.address}")
    server = _usb_ip_server(usb, usb_ip, reporter)
    live = LiveRun(
        brick, port, run_record, None if usb else pin, speed, usb_ip=server, tell=reporter.print
    )
    try:
        stopped = live.run(seconds)
        reporter.print(f"the run ended: {stopped.message or stopped.reason}")
        if stopped.reason == "fault":
            raise RunFaultError(f"the program stopped with a fault: {stopped.message}")
        finished = True
    except KeyboardInterrupt:
        run_record.end_cycles, run_record.digest = brick.cycles, brick.trace_digest()
        finished = False
    finally:
        port.close()
        if server is not None:
            server.close()
        if record is not None:
            run_record.save(record)
    answer = {
        "trace_digest": run_record.digest,
        "end_cycles": run_record.end_cycles,
        "signals": len(run_record.signals) + len(run_record.cable),
        "record": str(record) if record else None,
    }
    if not finished:
        raise InterruptError(**answer)
    return answer


def _replayed(brick: Any, kept: LiveRecord, reporter: Reporter) -> dict[str, Any]:
    same = replay_live(brick, kept)
    reporter.print(
        "the same run again" if same else "the trace digest DIFFERS from the recorded one"
    )
    return {"trace_digest": brick.trace_digest(), "same_as_replayed": same}


def _usb_ip_server(usb: str | None, port: int | None, reporter: Reporter) -> UsbIpServer | None:
    if port is None:
        return None
    if usb is not None:
        raise UsageError("--usb and --usb-ip both use the brick's only cable; choose one of them")
    server = UsbIpServer(port)
    reporter.tell(f"USB/IP on port {server.port}; as root: modprobe vhci-hcd, then")
    reporter.tell(f"  usbip --tcp-port {server.port} attach -r 127.0.0.1 -b 1-1")
    return server
