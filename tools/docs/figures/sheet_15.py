# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sheet on C called from Ada: layout, cost, a shared state, whole numbers."""

from __future__ import annotations

from pathlib import Path

from elftools.dwarf.die import DIE
from elftools.elf.elffile import ELFFile
from ravenbrick.timing.bounds import execution_times

from tools.docs.figures import SERIES, Edits, legend, new_figure, picture, project, run
from tools.docs.lessons import SHEETS, edited, files_of, steps, teaching_page

SHEET = SHEETS / "15-c-from-ada.md"
SOLUTION = teaching_page(SHEET)
SHARED, PACKED, SINGLE, OWN, WHOLE = "shared", "packed", "single", "own", "whole"
FACTOR = 0.25


def _edits(version: str) -> Edits:
    """The project after the step that makes the version, or after the whole solution."""
    files = {name.removeprefix("lab15/"): text for name, text in files_of(SHEET).items()}
    for name in ("src/tasks.adb", "timing.toml"):
        files[name] = (project("blank") / name).read_text("utf-8")
    last = {
        SHARED: ("src/tasks.adb", 1),
        PACKED: ("src/filters.ads", 2),
        SINGLE: ("src/filter.c", 1),
    }
    name, left = last.get(version, ("", 0))
    folders = ("lab15", "whole15") if version == WHOLE else ("lab15",)
    for page in (SHEET, SOLUTION):
        for step in steps(page.read_text("utf-8")):
            folder, _, file = step.argument.partition("/")
            if folder not in folders or (page, step.kind) == (SHEET, "file"):
                continue
            if step.kind == "edit":
                files[file] = edited(files[file], step.content)
            elif step.kind == "file":
                files[file] = step.content
            left -= file == name
            if file == name and not left:
                return files
    return files


def _image(version: str) -> Path:
    return project("blank", _edits(version)) / "build/robot/ram/robot.elf"


def _layout(image: Path, name: str) -> list[tuple[str, int, int]]:
    """Components of a structure in the debug information: name, offset and size in bytes."""

    def size(die: DIE) -> int:
        while "DW_AT_byte_size" not in die.attributes:
            die = die.get_DIE_from_attribute("DW_AT_type")
            if die.tag == "DW_TAG_array_type":
                count = next(die.iter_children()).attributes["DW_AT_upper_bound"].value + 1
                return int(count) * size(die.get_DIE_from_attribute("DW_AT_type"))
        return int(die.attributes["DW_AT_byte_size"].value)

    def offset(part: DIE) -> int:
        if place := part.attributes.get("DW_AT_data_member_location"):
            return int(place.value)
        return int(part.attributes["DW_AT_data_bit_offset"].value) // 8

    with image.open("rb") as file:
        for unit in ELFFile(file).get_dwarf_info().iter_CUs():
            for die in unit.iter_DIEs():
                known = die.attributes.get("DW_AT_name")
                if die.tag == "DW_TAG_structure_type" and known and known.value == name.encode():
                    return [
                        (
                            part.attributes["DW_AT_name"].value.decode(),
                            offset(part),
                            size(part),
                        )
                        for part in die.iter_children()
                    ]
    raise ValueError(f"{image}: no structure {name}")


def layout() -> str:
    """Bytes of the record, as the C compiler and as the Ada compiler with `Pack` see them."""
    figure, (axes,) = new_figure(7.0, 2.0)
    versions = ((SHARED, "filter_settings", "C"), (PACKED, "filters__settings", "packed"))
    for row, (version, name, _) in enumerate(versions):
        parts = _layout(_image(version), name)
        ends = [offset + size for _, offset, size in parts]
        gaps = [(end, part[1] - end) for end, part in zip(ends, parts[1:], strict=False)]
        for begin, length in filter(lambda gap: gap[1], gaps):
            axes.broken_barh([(begin, length)], (0.7 - row, 0.6), color="0.88", edgecolor="white")
            axes.text(begin + length / 2, 1 - row, "padding", ha="center", va="center", size=8)
        for (part, offset, size), colour in zip(parts, SERIES, strict=False):
            axes.broken_barh([(offset, size)], (0.7 - row, 0.6), color=colour, edgecolor="white")
            axes.text(
                offset + size / 2, 1 - row, part, ha="center", va="center", color="white", size=8
            )
    axes.set(xlabel="offset (bytes)", xlim=(0, 12), ylim=(-0.5, 1.5), xticks=range(13))
    axes.set_yticks([1, 0], [label for _, _, label in versions])
    return picture(figure)


def cost() -> str:
    """Bounds of one call of the filter, in four versions."""
    figure, (axes,) = new_figure(7.0, 2.6)
    versions = {SHARED: "0.5", SINGLE: "0.5f", OWN: "0.5f, own state", WHOLE: "whole numbers"}
    bounds = []
    for version in versions:
        function = "filter_whole" if version == WHOLE else "filter_step"
        found = execution_times(_image(version).read_bytes(), functions=(function,))
        bounds.append(found.functions[0].cycles + found.return_cycles)
    bars = axes.barh(range(len(versions)), bounds, color=SERIES[0])
    axes.bar_label(bars, padding=4)
    axes.set_yticks(range(len(versions)), list(versions.values()))
    axes.invert_yaxis()
    axes.set(xlabel="bound of one call (cycles)", xlim=(0, 1.15 * max(bounds)))
    return picture(figure)


def _outputs(inputs: tuple[float, float], jobs: int, shared: bool) -> list[list[float]]:
    states, outputs = [0.0, 0.0], [[0.0], [0.0]]
    for _ in range(jobs):
        for side in (0, 1):
            place = 0 if shared else side
            states[place] += FACTOR * (inputs[side] - states[place])
            outputs[side].append(states[place])
    return outputs


def state() -> str:
    """Outputs of both filters, and the numbers on the display in the end."""
    figure, (axes,) = new_figure(7.0, 3.2)
    for shared, version, dash in ((False, OWN, "--"), (True, SHARED, "-")):
        last = run("blank", "press", _edits(version)).screens[-1].text
        for side, name in enumerate(("left", "right")):
            values = _outputs((100.0, 0.0), 20, shared)[side]
            label = f"{name}, {'shared state' if shared else 'own state'}"
            axes.plot(values, dash, color=SERIES[side], label=label)
            shown = next(line for line in last if line.startswith(name))
            axes.plot(20.3, float(shown.split()[-1]), "o", color=SERIES[side])
    axes.set(xlabel="job", ylabel="output", xlim=(0, 20.8), ylim=(-4, 108), xticks=range(0, 21, 5))
    legend(axes, (0.5, 0.66), columns=2)
    return picture(figure)


def digits() -> str:
    """Distance at which the filter in whole numbers stops, over its digits behind the point."""
    from matplotlib.ticker import FixedLocator, NullFormatter  # slow to load

    figure, (axes,) = new_figure(7.0, 2.8)
    places = range(11)
    distances = []
    for place in places:
        scaled, held = 100 << place, 0
        for _ in range(200):
            held += int((scaled - held) / 4)
        distances.append((scaled - held) / (1 << place))
    axes.semilogy(places, distances, "o-", color=SERIES[0])
    axes.axhline(0.1, color="black", linestyle=":")
    axes.set(xlabel="binary digits behind the point", ylabel="distance from 100", xticks=places)
    axes.yaxis.set_major_locator(FixedLocator((0.01, 0.03, 0.1, 0.3, 1, 3)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    return picture(figure)
