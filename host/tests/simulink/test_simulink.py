# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulink models: files written here, and public ones whose folder the environment names."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import signal
from verification.support.codegen.simulink_files import (
    FIRST,
    INNER,
    ROOT,
    VARIABLES,
    block,
    line,
    run,
    single_file,
    whole_model,
)

from ravenbrick.codegen import generate_c
from ravenbrick.errors import DesignError
from ravenbrick.simulink import import_simulink, read_simulink, survey_simulink
from ravenbrick.simulink.blocks.table import IGNORED, MAKERS, STRUCTURE
from ravenbrick.simulink.numbers import matrix, scalar

PUBLIC = os.environ.get("RAVENBRICK_SLX_MODELS")


def split_model(path: Path) -> Path:
    """The example with a file per system, as today."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("simulink/blockdiagram.xml", f"{FIRST}<ModelInformation><Model/>"
                         "</ModelInformation>")  # fmt: skip
        root = ROOT.replace("{inner}", '<System Ref="system_3"/>')
        archive.writestr("simulink/systems/system_root.xml", f"{FIRST}<System>{root}</System>")
        archive.writestr("simulink/systems/system_3.xml", f"{FIRST}<System>{INNER}</System>")
    return path


TEXT = """\
Model {
  Name "controller"
  BlockParameterDefaults {
    Block { BlockType Sum Inputs "++" }
    Block {
      BlockType Gain
      Gain "Kp_value"
      "*2"
    }
  }
  System {
    Block {
      BlockType Inport
      Name "ref"
    }
    Block {
      BlockType SubSystem
      Name "PI"
      System {
        Block {
          BlockType Inport
          Name "e"
        }
        Block {
          BlockType Gain
          Name "Kp"
        }
        Block {
          BlockType DiscreteIntegrator
          Name "I"
          IntegratorMethod "Integration: Forward Euler"
          gainval "Ki"
          InitialCondition "0.5"
          SampleTime "0.01"
        }
        Block {
          BlockType Sum
          Name "Add"
          Inputs "++"
        }
        Block {
          BlockType Outport
          Name "u"
        }
        Line {
          SrcBlock "e"
          SrcPort 1
          Branch {
            DstBlock "Kp"
            DstPort 1
          }
          Branch {
            DstBlock "I"
            DstPort 1
          }
        }
        Line {
          SrcBlock "Kp"
          SrcPort 1
          DstBlock "Add"
          DstPort 1
        }
        Line {
          SrcBlock "I"
          SrcPort 1
          DstBlock "Add"
          DstPort 2
        }
        Line {
          SrcBlock "Add"
          SrcPort 1
          DstBlock "u"
          DstPort 1
        }
      }
    }
    Block {
      BlockType Saturate
      Name "Lim it"
      UpperLimit "3"
      LowerLimit "-3"
    }
    Block {
      BlockType Outport
      Name "out"
    }
    Line {
      SrcBlock "ref"
      SrcPort 1
      DstBlock "PI"
      DstPort 1
    }
    Line {
      SrcBlock "PI"
      SrcPort 1
      DstBlock "Lim it"
      DstPort 1
    }
    Line {
      SrcBlock "Lim it"
      SrcPort 1
      DstBlock "out"
      DstPort 1
    }
  }
}
"""


def text_model(path: Path) -> Path:
    """The example in the old text format, with a default that Kp takes over."""
    path.write_text(TEXT)
    return path


@pytest.mark.parametrize("write", [whole_model, split_model, text_model])
def test_all_three_file_forms_give_the_same_controller(
    write: Callable[[Path], Path], tmp_path: Path
) -> None:
    """Subsystem dissolved, variables put in, defaults used; simulated and generated."""
    diagram = import_simulink(write(tmp_path / "pi.slx"), 0.01, VARIABLES)
    given = np.random.default_rng(2).uniform(-2, 2, 200)
    integral = 0.5 + signal.lfilter([0.0, 0.02], [1.0, -1.0], given)
    assert run(diagram, given) == pytest.approx(np.clip(given + integral, -3, 3), abs=1e-5)
    assert "'<Root>/Kp'" in generate_c(diagram).files["pi.c"]


SINGLE = {
    "DiscreteTransferFcn": ({"Numerator": "[0.5 0.2]", "Denominator": "[1 -0.9 0.3]"},
                            lambda u: signal.lfilter([0, 0.5, 0.2], [1, -0.9, 0.3], u)),
    "DiscreteFilter": ({"Numerator": "[0.5, 0.2]", "Denominator": "[1 -0.9]"},
                       lambda u: signal.lfilter([0.5, 0.2], [1, -0.9], u)),
    "DiscreteFir": ({"Coefficients": "[0.25 0.5 0.25]"},
                    lambda u: signal.lfilter([0.25, 0.5, 0.25], [1.0], u)),
    "TransferFcn": ({"Numerator": "[1]", "Denominator": "[0.05 1]"},
                    lambda u: signal.lfilter(*signal.bilinear([1], [0.05, 1], 100), u)),
    "Saturate": ({"UpperLimit": "1.5", "LowerLimit": "-0.5"}, lambda u: np.clip(u, -0.5, 1.5)),
    "Abs": ({}, np.abs),
    "Signum": ({}, np.sign),
    "Bias": ({"Bias": "-1.25"}, lambda u: u - 1.25),
    "UnaryMinus": ({}, lambda u: -u),
    "DeadZone": ({"LowerValue": "-1", "UpperValue": "1"}, lambda u: u - np.clip(u, -1, 1)),
    "Quantizer": ({"QuantizationInterval": "0.5"}, lambda u: 0.5 * np.round(u / 0.5)),
    "UnitDelay": ({"InitialCondition": "2"}, lambda u: np.concatenate([[2.0], u[:-1]])),
    "Lookup_n-D": ({"BreakpointsForDimension1": "[-1 0 2]", "Table": "[3 0 1]",
                    "ExtrapMethod": "Clip"}, lambda u: np.interp(u, [-1, 0, 2], [3, 0, 1])),
    "ZeroOrderHold": ({"SampleTime": "0.02"}, lambda u: np.repeat(u[::2], 2)[: len(u)]),
}  # fmt: skip


@pytest.mark.parametrize("kind", SINGLE)
def test_a_block_means_what_it_means_there(kind: str, tmp_path: Path) -> None:
    """Between an inport and an outport."""
    parameters, reference = SINGLE[kind]
    root = block("Inport", "u", 1) + block(kind, "B", 2, **parameters) + block("Outport", "y", 3)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    diagram = import_simulink(single_file(tmp_path / "m.slx", root), 0.01)
    given = np.random.default_rng(4).uniform(-3, 3, 80)
    assert run(diagram, given) == pytest.approx(reference(given), abs=2e-5)


def test_what_is_not_supported_is_listed_by_path(tmp_path: Path) -> None:
    """Nothing is skipped in silence."""
    inner = block("Inport", "a", 5) + block("MATLABSystem", "Mystery", 6)
    root = block("Inport", "u", 1) + block("SubSystem", "Sub", 2, f"<System>{inner}</System>")
    root += block("Gain", "K", 3, Gain="unknown_gain") + line("1#out:1", "2#enable")
    path = single_file(tmp_path / "m.slx", root)
    with pytest.raises(DesignError, match="3 of 5 blocks cannot be imported") as caught:
        import_simulink(path, 0.01)
    detail = caught.value.detail
    assert "Sub (SubSystem): its port 'enable' has no block inside it" in detail
    assert "Sub/Mystery (MATLABSystem): it stands for something outside the model" in detail
    assert "K (Gain): the variable 'unknown_gain' is not given" in detail
    assert survey_simulink(path).supported == 3


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ({"readme.txt": "hello"}, "no Simulink model is inside"),
        ({"simulink/blockdiagram.xml": "<a><b></a>"}, "is not XML"),
        ({"simulink/blockdiagram.xml": '<?xml version="1.0" encoding="uuf-8"?><a/>'}, "uuf-8"),
        ({"simulink/blockdiagram.xml": '<?xml version="1.0" encoding="utf-7"?><a/>'}, "is not XML"),
        (
            {"simulink/blockdiagram.xml": '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'},
            "has a document type",
        ),
        ({"simulink/blockdiagram.xml": "<a>" * 400}, "nested more than"),
        ({"simulink/blockdiagram.xml": " " * (65 << 20)}, "unpacks to more than 64 MB"),
    ],
)
def test_hostile_archives_are_refused(
    contents: dict[str, str], message: str, tmp_path: Path
) -> None:
    """Entities, bombs, depth, other files."""
    path = tmp_path / "m.slx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in contents.items():
            archive.writestr(name, text)
    with pytest.raises(DesignError, match=message):
        read_simulink(path)


@pytest.mark.parametrize("number", ["9" * 5_000, "999999999", "²"])
def test_a_number_that_no_model_has_ends_with_a_sentence(number: str, tmp_path: Path) -> None:
    """Of ports, at blocks and at lines in both ways of writing them, of signs and of a mask's
    places: no traceback, and no memory for so many."""
    root = block("Inport", "u", 1, Port=number)
    root += block("Sum", "S", 2, Inputs=number)
    root += block("Product", "P", 3, Inputs=number)
    root += block("Mystery", "M", 4, Ports=f"[{number}, {number}]")
    root += block("Gain", "K", 5, MaskVariables=f"k=@{number};", MaskValueString="1|2")
    root += line(f"1#out:{number}", "2#in:1") + line("1#out:1", f"2#in:{number}")
    older = {"SrcBlock": "u", "SrcPort": number, "DstBlock": "P", "DstPort": number}
    entries = "".join(f'<P Name="{name}">{text}</P>' for name, text in older.items())
    root += f"<Line>{entries}</Line>"
    path = single_file(tmp_path / "m.slx", root)
    survey_simulink(path)
    with pytest.raises(DesignError, match="blocks cannot be imported"):
        import_simulink(path, 0.01)


def _directory_begins_later(content: bytearray) -> None:
    """The end record says so."""
    place = slice(len(content) - 6, len(content) - 2)
    later = int.from_bytes(content[place], "little") + 1_000
    content[place] = later.to_bytes(4, "little")


def _name_is_no_utf_8(content: bytearray) -> None:
    """Before its data the first file has another name than in the directory, in UTF-8."""
    content[7] |= 0x08
    content[30] = 0xFF


def _data_is_wrong(content: bytearray) -> None:
    """Of the first file, whose name and length are as before."""
    begin = 30 + int.from_bytes(content[26:28], "little")
    content[begin : begin + 8] = b"\xff" * 8


@pytest.mark.parametrize("damage", [_directory_begins_later, _name_is_no_utf_8, _data_is_wrong])
def test_an_archive_that_cannot_be_unpacked_is_damaged(
    damage: Callable[[bytearray], None], tmp_path: Path
) -> None:
    path = split_model(tmp_path / "m.slx")
    content = bytearray(path.read_bytes())
    damage(content)
    path.write_bytes(content)
    with pytest.raises(DesignError, match=r"m\.slx: the archive is damaged"):
        read_simulink(path)


def test_text_that_is_no_model_is_refused(tmp_path: Path) -> None:
    """Neither zip nor .mdl; braces that do not match."""
    path = tmp_path / "m.mdl"
    for text, message in (
        ("hello", "no Model section"),
        ("Model {", "ends inside"),
        ("}", "brace"),
    ):
        path.write_text(text)
        with pytest.raises(DesignError, match=message):
            read_simulink(path)


def test_numbers_are_read_without_running_anything() -> None:
    """Arithmetic and variables; calls, huge powers and ragged matrices are refused."""
    assert scalar("2*pi/(1+x)^2", {"x": 1.0}) == pytest.approx(1.5707963)
    assert matrix("[1 2; 3, -4]", {}) == [[1.0, 2.0], [3.0, -4.0]]
    for text in ("exec('x')", "2^999", "[1 2", "a.b", "__import__('os')"):
        with pytest.raises(ValueError, match=r"not|power|no number"):
            scalar(text, {})
    with pytest.raises(ValueError, match="different lengths"):
        matrix("[1 2; 3]", {})


# The types of block that make up 99 % of 32 public models (34,300 blocks), most frequent first.
FREQUENT = """
    Inport Outport SubSystem Sum Constant From Product Reference Gain Goto BusSelector Mux
    DataTypeConversion Signum Switch Demux Saturate Selector ActionPort Abs Logic
    DiscreteIntegrator Terminator Math RelationalOperator UnitDelay Delay Trigonometry Reshape
    BusAssignment SignalConversion Sqrt DeadZone Merge MinMax Scope Concatenate SwitchCase
    BusCreator Bias RateTransition If DotProduct Lookup2D Interpolation_n-D
""".split()


def test_the_forty_five_frequent_types_have_a_counterpart() -> None:
    """With ports, subsystems and sinks; a Reference is looked up by its library and name."""
    assert len(FREQUENT) == 45
    assert {kind for kind in FREQUENT if kind not in {*MAKERS, *STRUCTURE, *IGNORED}} == {
        "Reference"
    }


def public_models() -> list[Path]:
    """Models in the folder that RAVENBRICK_SLX_MODELS names."""
    if PUBLIC is None:
        return []
    return sorted(p for p in Path(PUBLIC).rglob("*") if p.suffix.lower() in (".slx", ".mdl"))


@pytest.mark.skipif(PUBLIC is None, reason="RAVENBRICK_SLX_MODELS names no folder of models")
@pytest.mark.parametrize("path", public_models(), ids=lambda path: path.name)
def test_a_public_model_is_read_and_its_other_blocks_are_listed(path: Path) -> None:
    """Every block is either imported or refused by its path with a reason; other files are named.

    Some repositories have empty models, and files of other kinds with a model's ending.
    """
    repository = path.parent.relative_to(PUBLIC or "").parts[:2]
    try:
        survey = survey_simulink(path, libraries=[Path(PUBLIC or "", *repository)])
    except DesignError as error:
        assert f"{path}" in f"{error}"
        return
    assert 0 <= survey.supported <= survey.blocks
    assert all(refusal.path and refusal.reason for refusal in survey.refusals)
    print(f"{path.name}: {survey.supported} of {survey.blocks} blocks")
