# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper's figures 4 and 5 as Simulink models.

`python write_models.py [FOLDER]` writes figure4.slx and figure5.slx, always with the same bytes. An
.slx file is a zip in the Open Packaging Conventions; the parts are those of R2014b, which every
later release reads.
"""

from __future__ import annotations

import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

# PI gains whose zero cancels the motor's pole and whose loop settles within 2 % after 0.4 s.
GAINS = "Kp = 0.361;\nKi = 9.76;"
CHARGED_BATTERY = "battery = 8.0;"
SAMPLE_TIME = "0.004"

XML = '<?xml version="1.0" encoding="utf-8"?>\n'
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
MATHWORKS = "http://schemas.mathworks.com"
MIME = "application/vnd."

CONTENT_TYPES = f"""{XML}<Types xmlns="{PACKAGE}/content-types">
  <Default ContentType="{MIME}openxmlformats-package.relationships+xml" Extension="rels"/>
  <Default ContentType="{MIME}mathworks.simulink.mdl+xml" Extension="xml"/>
  <Override ContentType="{MIME}openxmlformats-package.core-properties+xml"
    PartName="/metadata/coreProperties.xml"/>
  <Override ContentType="{MIME}mathworks.package.coreProperties+xml"
    PartName="/metadata/mwcoreProperties.xml"/>
</Types>
"""
RELATIONSHIPS = f"""{XML}<Relationships xmlns="{PACKAGE}/relationships">
  <Relationship Id="blockDiagram" Target="simulink/blockdiagram.xml"
    Type="{MATHWORKS}/simulink/2010/relationships/blockDiagram"/>
  <Relationship Id="coreprops" Target="metadata/coreProperties.xml"
    Type="{PACKAGE}/relationships/metadata/core-properties"/>
  <Relationship Id="rId1" Target="metadata/mwcoreProperties.xml"
    Type="{MATHWORKS}/package/2012/relationships/coreProperties"/>
</Relationships>
"""
CORE_PROPERTIES = f"""{XML}<cp:coreProperties xmlns:cp="{PACKAGE}/metadata/core-properties"
  xmlns:dc="http://purl.org/dc/elements/1.1/">
  <cp:category>Model</cp:category>
  <dc:creator>Ravenbrick contributors</dc:creator>
  <dc:description>Apache-2.0</dc:description>
  <cp:version>R2014b</cp:version>
</cp:coreProperties>
"""
MATLAB_PROPERTIES = f"""{XML}<mwcoreProperties xmlns="{MATHWORKS}/package/2012/coreProperties">
  <contentType>{MIME}mathworks.simulink.model</contentType>
  <contentTypeFriendlyName>Simulink Model</contentTypeFriendlyName>
  <matlabRelease>R2014b</matlabRelease>
</mwcoreProperties>
"""


def parameters(values: dict[str, str], indent: int) -> str:
    """Named parameters, one a line."""
    space = " " * indent
    return "".join(f'{space}<P Name="{key}">{escape(text)}</P>\n' for key, text in values.items())


def block(number: int, kind: str, name: str, position: str, **values: str) -> str:
    """A block; `position` is left, top, right, bottom in pixels."""
    inner = parameters({"Position": f"[{position}]", "ZOrder": str(number), **values}, 8)
    title = quoteattr(name)
    return f'      <Block BlockType="{kind}" Name={title} SID="{number}">\n{inner}      </Block>\n'


def line(number: int, source: int, *targets: tuple[int, int, str]) -> str:
    """A line from a block to inputs (block, port); its corners are relative moves."""
    head = {"ZOrder": str(number), "Src": f"{source}#out:1"}
    ends = []
    for target, port, corners in targets:
        end = {"ZOrder": str(number)} if len(targets) > 1 else {}
        end |= {"Points": corners} if corners else {}
        ends.append(end | {"Dst": f"{target}#in:{port}"})
    inner = parameters(head, 8)
    if len(ends) == 1:
        inner += parameters(ends[0], 8)
    else:
        inner += "".join(
            f"        <Branch>\n{parameters(end, 10)}        </Branch>\n" for end in ends
        )
    return f"      <Line>\n{inner}      </Line>\n"


def pi_controller(number: int, position: str, **values: str) -> str:
    """The library's PID controller as a PI in parallel form, P + I/s or P + I Ts/(z - 1)."""
    return block(
        number,
        "Reference",
        "PI Controller",
        position,
        Ports="[1, 1]",
        LibraryVersion="1.354",
        SourceBlock="simulink/Continuous/PID Controller",
        SourceType="PID 1dof",
        Controller="PI",
        Form="Parallel",
        P="Kp",
        I="Ki",
        **values,
    )


def difference(number: int, position: str) -> str:
    """Set-point minus measurement."""
    values = {"Ports": "[2, 1]", "IconShape": "round", "Inputs": "|+-"}
    return block(number, "Sum", "Sum", position, **values)


def model(workspace: str, settings: dict[str, dict[str, str]], contents: Sequence[str]) -> str:
    """A model whose variables are assigned when it is opened; settings by component."""
    components = "".join(
        f'            <Object ObjectID="{number}" Version="1.14.3" ClassName="Simulink.{name}">\n'
        f"{parameters(values, 14)}            </Object>\n"
        for number, (name, values) in enumerate(settings.items(), 2)
    )
    system = parameters({"Location": "[100, 100, 900, 500]", "Open": "on", "ZoomFactor": "100"}, 6)
    number = sum(part.lstrip().startswith("<Block") for part in contents)
    system += parameters({"SIDHighWatermark": str(number)}, 6)
    return f"""{XML}<ModelInformation Version="1.0">
  <Model>
{parameters({"SavedCharacterEncoding": "UTF-8", "PreLoadFcn": workspace}, 4)}\
    <ConfigurationSet>
      <Array PropName="ConfigurationSets" Type="Handle" Dimension="1*1">
        <Object ObjectID="1" Version="1.14.3" ClassName="Simulink.ConfigSet">
          <Array PropName="Components" Type="Handle" Dimension="1*{len(settings)}">
{components}          </Array>
          <P Name="Name">Configuration</P>
        </Object>
      </Array>
      <Object Reference="true" PropName="ActiveConfigurationSet" ObjectID="1" \
ClassName="Simulink.ConfigSet"/>
    </ConfigurationSet>
    <System>
{system}{"".join(contents)}    </System>
  </Model>
</ModelInformation>
"""


def configuration(
    solver: dict[str, str], optimisation: dict[str, str], target: str
) -> dict[str, dict[str, str]]:
    """Every component of a configuration; what is not set keeps Simulink's default."""
    return {
        "SolverCC": {"StartTime": "0.0", "StopTime": "1.0", **solver},
        "DataIOCC": {},
        "OptimizationCC": optimisation,
        "DebuggingCC": {},
        "HardwareCC": {"ProdHWDeviceType": "ARM Compatible->ARM 7"},
        "ModelReferenceCC": {},
        "SFSimCC": {},
        "RTWCC": {"SystemTargetFile": target},
    }


def figure4() -> str:
    """Speed control loop for the NXT motor."""
    contents = [
        block(1, "Step", "voltage step", "30, 65, 60, 95", Time="0", Before="0", After="1",
              SampleTime="0"),
        difference(2, "115, 70, 135, 90"),
        pi_controller(3, "185, 62, 245, 98", TimeDomain="Continuous-time"),
        block(4, "TransferFcn", "NXT Motor Transfer Fcn", "300, 62, 400, 98",
              Numerator="[2.029]", Denominator="[0.037 1]"),
        block(5, "Gain", "degrees/s", "325, 145, 385, 175", BlockMirror="on", Gain="57.2958"),
        block(6, "Gain", "voltage", "215, 145, 265, 175", BlockMirror="on", Gain="1/116"),
        block(7, "Scope", "Scope", "480, 34, 510, 76", Ports="[2]", NumInputPorts="2"),
        line(1, 1, (2, 1, ""), (7, 1, "[25, 0; 0, -35]")),
        line(2, 2, (3, 1, "")),
        line(3, 3, (4, 1, "")),
        line(4, 4, (5, 1, "[40, 0; 0, 80]")),
        line(5, 5, (6, 1, "")),
        line(6, 6, (2, 2, "[-85, 0]"), (7, 2, "[-20, 0; 0, 50; 270, 0]")),
    ]  # fmt: skip
    settings = configuration({"Solver": "ode45", "MaxStep": "0.01"}, {}, "grt.tlc")
    return model(GAINS, settings, contents)


def figure5() -> str:
    """The PI controller alone, for code generation."""
    contents = [
        block(1, "Inport", "input_voltage", "40, 73, 70, 87", Port="1", OutDataTypeStr="single"),
        block(2, "Inport", "real_voltage", "40, 133, 70, 147", Port="2", OutDataTypeStr="single"),
        difference(3, "125, 70, 145, 90"),
        pi_controller(
            4, "200, 62, 260, 98", TimeDomain="Discrete-time", SampleTime=SAMPLE_TIME,
            IntegratorMethod="Forward Euler", LimitOutput="on", UpperSaturationLimit="battery",
            LowerSaturationLimit="-battery", AntiWindupMode="clamping",
        ),
        block(5, "Outport", "corrected voltage", "320, 73, 350, 87", Port="1"),
        line(1, 1, (3, 1, "")),
        line(2, 2, (3, 2, "[60, 0]")),
        line(3, 3, (4, 1, "")),
        line(4, 4, (5, 1, "")),
    ]  # fmt: skip
    solver = {"Solver": "FixedStepDiscrete", "FixedStep": SAMPLE_TIME}
    settings = configuration(solver, {"InlineParams": "off"}, "ert.tlc")
    return model(f"{GAINS}\n{CHARGED_BATTERY}", settings, contents)


def write(path: Path, diagram: str) -> None:
    """The archive, stored without compression so that every machine writes the same bytes."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in (
            ("[Content_Types].xml", CONTENT_TYPES),
            ("_rels/.rels", RELATIONSHIPS),
            ("metadata/coreProperties.xml", CORE_PROPERTIES),
            ("metadata/mwcoreProperties.xml", MATLAB_PROPERTIES),
            ("simulink/blockdiagram.xml", diagram),
        ):
            archive.writestr(zipfile.ZipInfo(name), text)


def main() -> None:
    """Write both models into the folder given, or beside this file."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    write(folder / "figure4.slx", figure4())
    write(folder / "figure5.slx", figure5())


if __name__ == "__main__":
    main()
