# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The programs for single devices as bricks of the site, with the inputs of their pictures."""

from __future__ import annotations

import json

from ravenbrick.cli.view import DESIGN, IMAGE, NO_DESIGN, SESSION, SOURCES, WORST_PATHS
from ravenbrick.image.elf import read_image
from ravenbrick.image.source_texts import source_texts

from examples.devices import pictures
from tools.docs.lessons import ROOT

__all__ = ["device_files"]


def device_files(name: str) -> dict[str, bytes]:
    """Session, image and sources of a program; it is built and run once natively."""
    example = pictures.EXAMPLES[name]
    brick = pictures.run(name)
    until_ms, until_cycles = int(example.at_ms), brick.cycles(example.at_ms)
    session = {
        "project": name,
        "scenario": None,
        "configuration": pictures.surroundings(example),
        "probes": [],
        "tasks": [],
        "tunables": [],
        "inputs": [
            {"at_cycles": brick.cycles(at_ms), "name": quantity, "value": value}
            for at_ms, quantity, value in example.inputs
        ],
        "until_ms": until_ms,
        "until_cycles": until_cycles,
        "digest": brick.device.trace_digest(),
    }
    image = read_image(pictures.image_file(name))
    folders = (pictures.HERE / name, ROOT / "drivers", ROOT / "runtime")
    return {
        SESSION: json.dumps(session).encode(),
        IMAGE: image.content,
        SOURCES: json.dumps(source_texts(image, folders)).encode(),
        DESIGN: NO_DESIGN,
        WORST_PATHS: b"{}",
    }
