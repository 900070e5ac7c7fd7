# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The wheel, installed by the steps of the Containerfile, and used far from the tree."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sysconfig
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tools.dist import write_wheel

ROOT = Path(__file__).resolve().parents[2]
CONTAINERFILE = ROOT / "tools" / "Containerfile"
WITH_A_WHEEL = pytest.mark.long("builds and installs a wheel")
# Libraries of others come from the environment of the tests; nothing else of the tree is opened,
# and the sandbox is told the folders above them.
NO_TREE = """
import os, sys
TREE, LIBRARIES = {tree!r}, {libraries!r}
def refuse(event, arguments):
    if event in ("open", "os.listdir", "os.scandir", "subprocess.Popen"):
        for word in (arguments[0], *(arguments[1] if event == "subprocess.Popen" else ())):
            path = os.path.abspath(os.fsdecode(word)) if isinstance(word, (str, bytes)) else ""
            known = path.startswith(LIBRARIES) or LIBRARIES.startswith(path + "/")
            if path.startswith(TREE + "/") and not known:
                os.write(2, f"{{event}} {{path}}: is in the tree".encode())
                os._exit(99)
sys.addaudithook(refuse)
"""


def steps() -> list[tuple[str, str]]:
    """Instructions of the Containerfile."""
    text = re.sub(r"\\\n\s*", "", CONTAINERFILE.read_text())
    lines = [line.partition(" ") for line in text.splitlines() if line and line[0] != "#"]
    return [(word, rest) for word, _, rest in lines]


@dataclass(frozen=True)
class Machine:
    """Folder in place of /opt, and the environment of a user who has nothing else."""

    opt: Path
    environment: dict[str, str]

    def shell(self, command: str, folder: Path | None = None, code: int = 0) -> str:
        """Run a command line; its output."""
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder or self.opt,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        assert done.returncode == code, f"{command}\n{done.stdout[-3000:]}"
        return done.stdout

    def here(self, text: str) -> str:
        """A step's text with this folder for /opt, as the shell reads it."""
        return text.replace("/opt/", str(self.opt).replace(" ", "\\ ") + "/")

    @property
    def tree(self) -> dict[Path, bytes]:
        """Files that the wheel brought besides the package, without Python's own cache."""
        (tree,) = self.opt.glob("ravenbrick/lib/python3*/site-packages/ravenbrick/tree")
        files = (path for path in tree.rglob("*") if path.is_file() and path.suffix != ".pyc")
        return {path: path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    """The wheel, installed as in the container, in a folder whose name is not an easy one."""
    opt = tmp_path_factory.mktemp("wheel") / "Übung 1"
    write_wheel(opt / "wheel")
    environment = {"HOME": str(opt / "home"), "PATH": "/usr/bin:/bin", "LANG": "C.UTF-8"}
    machine = Machine(opt, environment | {"PIP_NO_INDEX": "1", "PIP_NO_DEPS": "1"})
    for word, rest in steps():
        if word == "RUN" and not rest.startswith(("apt-get", "useradd")):
            machine.shell(machine.here(rest))
        if word == "ENV":
            name, _, value = rest.partition("=")
            machine.environment[name] = value.replace("/opt", str(opt)).replace(
                f"${name}", machine.environment[name]
            )
        if rest.startswith("python3 -m venv"):
            libraries = sysconfig.get_paths()["purelib"]
            (own,) = opt.glob("ravenbrick/lib/python3*/site-packages")
            (own / "no_tree.py").write_text(NO_TREE.format(tree=str(ROOT), libraries=libraries))
            (own / "libraries.pth").write_text(f"{libraries}\nimport no_tree\n")
    return machine


@WITH_A_WHEEL
def test_a_user_works_without_the_tree(machine: Machine) -> None:
    """From a template to a graded robot; what was installed stays as it is."""
    before = machine.tree
    folder = machine.opt / "a user's folder"
    folder.mkdir()
    machine.shell("ravenbrick new my-robot", folder)
    machine.shell("ravenbrick build my-robot && ravenbrick run my-robot press", folder)
    machine.shell("ravenbrick view my-robot press --out page", folder)
    assert (folder / "page" / "index.html").is_file()
    machine.shell("ravenbrick analyse my-robot", folder)
    machine.shell("mkdir class && cp -r my-robot class/ada", folder)
    rubric = '"$(ravenbrick home)/docs/lessons/rubrics/lab-01.toml"'
    graded = machine.shell(f"ravenbrick grade class --rubric {rubric}", folder)
    assert "ada: 8 of 10" in graded
    machine.shell("ravenbrick monitor --help && ravenbrick debug --help", folder)
    image = (folder / "my-robot/build/my-robot/ram/my-robot.elf").read_bytes()
    assert str(ROOT).encode() not in image
    assert machine.tree == before


@WITH_A_WHEEL
def test_a_user_designs_without_the_tree(machine: Machine) -> None:
    """The design's Python and its libraries are found."""
    machine.shell("ravenbrick new bench --template motor && ravenbrick design bench")


@WITH_A_WHEEL
def test_the_tree_is_out_of_reach(machine: Machine) -> None:
    """The two tests above can fail."""
    output = machine.shell(f"ravenbrick build {ROOT}/examples/blank", code=99)
    assert output.endswith("is in the tree")


@WITH_A_WHEEL
def test_equal_inputs_give_equal_wheels(machine: Machine, tmp_path: Path) -> None:
    """Made once more, the wheel has the same name and the same bytes."""
    (first,) = (machine.opt / "wheel").glob("*.whl")
    again = write_wheel(tmp_path)
    assert again.name == first.name and again.read_bytes() == first.read_bytes()


@WITH_A_WHEEL
def test_the_container_has_what_doctor_asks_for(machine: Machine) -> None:
    """The set-up installs these packages, too."""
    (step,) = (rest for _, rest in steps() if rest.startswith("apt-get"))
    names = re.search(r"--no-install-recommends ([^&]+)", step)
    assert names is not None
    wanted = machine.shell("PATH=/nowhere exec ravenbrick/bin/ravenbrick doctor", code=4)
    lines = re.findall(r"'apt-get install --no-install-recommends ([^']+)'", wanted)
    # Where Landlock isolates submissions, doctor does not miss bubblewrap.
    assert set(names[1].split()) == {*" ".join(lines).split(), "python3-venv", "bubblewrap"}
    assert set(names[1].split()) <= set((ROOT / "tools" / "pins.sh").read_text().split())


@WITH_A_WHEEL
def test_the_container_is_built(machine: Machine) -> None:
    """By whatever builder there is; its last step but one for root is `ravenbrick doctor`."""
    programs = [name for name in ("podman", "docker", "buildah") if shutil.which(name)]
    working = [
        name
        for name in programs
        if subprocess.run([name, "info"], capture_output=True).returncode == 0
    ]
    if not working:
        pytest.skip("neither podman nor docker nor buildah works here")
    command = [working[0], "build", "--tag", "ravenbrick", "--file", str(CONTAINERFILE)]
    subprocess.run([*command, str(machine.opt / "wheel")], check=True)


def test_the_dev_container_of_a_project_is_this_container() -> None:
    """By the name of its image and of its user."""
    files = ROOT / "host" / "src" / "ravenbrick" / "project" / "templates" / "files"
    container = json.loads((files / ".devcontainer+devcontainer.json").read_text())
    assert container["remoteUser"] == dict(steps())["USER"]
    assert f"--tag {container['image']} " in CONTAINERFILE.read_text()


def test_the_steps_need_no_root_for_the_user() -> None:
    """What follows USER runs as an ordinary user, and nothing after it installs."""
    words = [word for word, _ in steps()]
    assert "RUN" not in words[words.index("USER") :]
    assert os.path.basename(dict(steps())["WORKDIR"]) == dict(steps())["USER"]


def test_the_tests_run_with_versions_that_the_wheel_allows() -> None:
    """Each dependency has a pinned version, within its range."""
    project = tomllib.loads((ROOT / "host" / "pyproject.toml").read_text())["project"]
    pins = re.findall(r"^([\w.-]+)==(\S+)", (ROOT / "tools/requirements/run.txt").read_text(), re.M)
    versions = {canonicalize_name(name): version for name, version in pins}
    for wish in [*project["dependencies"], *project["optional-dependencies"]["export"]]:
        requirement = Requirement(wish)
        assert versions[canonicalize_name(requirement.name)] in requirement.specifier, wish
