# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick wcet` with mistakes: each is named, with what to do, in JSON."""

from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.project.workspace import Workspace

if importlib.util.find_spec("virtual_brick") is None:
    pytest.skip("the module virtual_brick is not built", allow_module_level=True)

ROOT = Path(__file__).resolve().parents[3]
FUNCTION = "functional_step_instance"


@pytest.fixture
def image() -> Path:
    path = Workspace.of(ROOT / "examples" / "vehicle").image("ram", "vehicle")
    if not path.is_file():
        pytest.skip("the vehicle is not built; 'ravenbrick build examples/vehicle' builds it")
    return path


def refused(code: int, *arguments: str | Path) -> str:
    """What the command says when it ends with this code."""
    result = CliRunner().invoke(app, ["wcet", *map(str, arguments), "--json"])
    answer = json.loads(result.stdout)
    assert (result.exit_code, answer["ok"], answer["exit_code"]) == (code, False, code), answer
    return str(answer["error"])


@pytest.mark.parametrize("options", [[], ["--own-data"]])
def test_a_misspelt_function_is_told_with_those_alike(image: Path, options: list[str]) -> None:
    said = refused(2, image, "functional_stp_instance", *options)
    assert f"no function 'functional_stp_instance'; did you mean {FUNCTION}" in said
    assert "lists them" in refused(2, image, "qqqqqqqqqqqq", *options)


@pytest.mark.parametrize("options", [[], ["--own-data"]])
def test_a_damaged_image_is_named(image: Path, tmp_path: Path, options: list[str]) -> None:
    half = tmp_path / "half.elf"
    half.write_bytes(image.read_bytes()[:100_000])
    assert refused(6, half, FUNCTION, *options).startswith(f"{half}: ELF file: ")


def test_annotations_that_are_no_text_are_named_with_their_line(
    image: Path, tmp_path: Path
) -> None:
    facts = tmp_path / "facts.toml"
    facts.write_bytes("# one\n# für\n".encode("latin-1"))
    said = refused(3, image, FUNCTION, "--annotations", facts)
    assert f"{facts}:2: not UTF-8 text" in said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# one\n[[interrupt]]\n", "2: unknown field `interrupt`, expected one of `loop`, "),
        ("[[loop]]\nline =\n", "2: "),
    ],
)
def test_annotations_of_another_form_are_named_with_their_line(
    text: str, said: str, image: Path, tmp_path: Path
) -> None:
    """Such as the timing.toml of a project."""
    facts = tmp_path / "facts.toml"
    facts.write_text(text)
    assert refused(3, image, FUNCTION, "--annotations", facts).startswith(f"{facts}:{said}")


def test_a_damaged_image_is_named_beside_annotations_too(image: Path, tmp_path: Path) -> None:
    half, facts = tmp_path / "half.elf", tmp_path / "facts.toml"
    half.write_bytes(image.read_bytes()[:100_000])
    facts.write_text("")
    said = refused(6, half, FUNCTION, "--annotations", facts)
    assert said.startswith(f"{half}: ELF file: ")


def test_what_own_data_starts_from_needs_own_data(image: Path) -> None:
    assert "need --own-data; add it" in refused(2, image, FUNCTION, "--after", "adainit")


def test_the_worst_path_on_the_source_adds_up_to_the_bound(image: Path, tmp_path: Path) -> None:
    file = tmp_path / "path.html"
    command = ["wcet", str(image), FUNCTION, "--html", str(file), "--json"]
    result = CliRunner().invoke(app, command)
    told = json.loads(result.stdout)
    assert result.exit_code == 0, told
    cells = re.findall(
        r'class="share">(\d+)</td>', file.read_text("utf-8").partition("<details")[2]
    )
    whole = re.search(r"Line by line: worst path (\d+) cycles", file.read_text("utf-8"))
    assert whole is not None
    assert sum(map(int, cells)) == int(whole[1])
    back = re.search(r"on its lines and (\d+) for the fetches", file.read_text("utf-8"))
    assert back is not None
    assert int(whole[1]) + int(back[1]) == told["cycles"]


def test_known_memory_has_no_worst_path_on_the_source(image: Path, tmp_path: Path) -> None:
    options = ["--own-data", "--html", str(tmp_path / "path.html")]
    assert "omit --own-data" in refused(2, image, FUNCTION, *options)
