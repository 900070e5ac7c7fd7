# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`make dist`: one wheel that works without the tree; Debian's cross tools are all else it needs.

setuptools makes the package `ravenbrick`; this program adds the compiled module `virtual_brick` of
the running Python, and below `ravenbrick/tree` the folders that `ravenbrick.project.workspace.tree`
looks for, laid out as in a checkout. Equal inputs give equal bytes.
"""

from __future__ import annotations

import base64
import hashlib
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import virtual_brick
from elftools.elf.elffile import ELFFile
from elftools.elf.gnuversions import GNUVerNeedSection
from ravenbrick.atomic_write import atomic_write

from tools.style.tidy import ROOT, tracked_files

TYPES = ROOT / "virtual-brick" / "bindings" / "python" / "virtual_brick.pyi"
BUILT = ROOT / "build" / "dist"
# What a user's project is made from and built with; tests and measurements stay behind.
SHIPPED = (
    "catalogue/",
    "drivers/",
    "examples/",
    "runtime/",
    "docs/lessons/rubrics/",
    "tools/Containerfile",
)
SHIPPED_TOOLS = (".gpr", ".cgpr", ".mk", ".awk", ".cfg", ".rules")
LEFT_OUT = {"tests", "regulation"}
BUILD = "from setuptools.build_meta import build_wheel; build_wheel('wheel')"
EPOCH = (1980, 1, 1, 0, 0, 0)


def shipped_files() -> dict[str, Path]:
    """The files of the tree that the wheel has, by their path in the tree."""
    files = {path.relative_to(ROOT).as_posix(): path for path in tracked_files()}
    return {
        name: path
        for name, path in files.items()
        if (name.startswith(SHIPPED) and not LEFT_OUT & set(name.split("/")))
        or (name.startswith("tools/") and name.endswith(SHIPPED_TOOLS))
    }


def package_files(scratch: Path) -> dict[str, bytes]:
    """What setuptools makes of host/."""
    project = scratch / "host"
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    shutil.copytree(ROOT / "host" / "src", project / "src", ignore=ignored)
    for path in (ROOT / "host" / "pyproject.toml", ROOT / "LICENSE"):
        shutil.copy(path, project)
    subprocess.run([sys.executable, "-c", BUILD], cwd=project, check=True, capture_output=True)
    (wheel,) = (project / "wheel").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def module_files(scratch: Path) -> dict[str, bytes]:
    """The compiled module without its debug information, and its types."""
    module = Path(str(virtual_brick.__file__))
    stripped = scratch / module.name
    subprocess.run(["strip", "-o", str(stripped), str(module)], check=True)
    return {module.name: stripped.read_bytes(), TYPES.name: TYPES.read_bytes()}


def platform_tag(library: bytes, scratch: Path) -> str:
    """The oldest GNU C library that the compiled module runs with, as a wheel's platform."""
    path = scratch / "module.so"
    path.write_bytes(library)
    with path.open("rb") as stream:
        section = ELFFile(stream).get_section_by_name(".gnu.version_r")
        assert isinstance(section, GNUVerNeedSection)
        needed = section.iter_versions()
        names = [auxiliary.name for _, versions in needed for auxiliary in versions]
    minor = max(int(name.split(".")[1]) for name in names if name.startswith("GLIBC_2."))
    return f"manylinux_2_{minor}_{platform.machine()}"


def with_record(files: dict[str, bytes], record: str) -> dict[str, bytes]:
    """The files and their list, as the format of wheels wants it."""
    lines = []
    for name, content in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
        lines.append(f"{name},sha256={digest},{len(content)}\n")
    return dict(sorted(files.items())) | {record: "".join([*lines, f"{record},,\n"]).encode()}


def write_wheel(folder: Path = BUILT) -> Path:
    """Write the wheel into the folder, which then has no other."""
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        files = package_files(scratch)
        (info,) = {file.split("/")[0] for file in files if ".dist-info/" in file}
        module = module_files(scratch)
        (library,) = [content for file, content in module.items() if file.endswith(".so")]
        tag = f"cp311-abi3-{platform_tag(library, scratch)}"
        about = files[f"{info}/WHEEL"].decode()
        about = about.replace("py3-none-any", tag).replace("Purelib: true", "Purelib: false")
        files |= module | {f"{info}/WHEEL": about.encode()}
        for file, path in shipped_files().items():
            files[f"ravenbrick/tree/{file}"] = path.read_bytes()
        del files[f"{info}/RECORD"]
        packed = scratch / "wheel"
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for file, content in with_record(files, f"{info}/RECORD").items():
                entry = zipfile.ZipInfo(file, EPOCH)
                entry.external_attr = 0o100644 << 16
                archive.writestr(entry, content, zipfile.ZIP_DEFLATED, 9)
        shutil.rmtree(folder, ignore_errors=True)
        wheel = folder / f"{info.removesuffix('.dist-info')}-{tag}.whl"
        atomic_write(wheel, packed.read_bytes())
        return wheel


def main() -> None:
    """Write the wheel and say where it is."""
    wheel = write_wheel()
    code = "with" if virtual_brick.JIT else "without"
    print(f"{wheel.relative_to(ROOT)}: {wheel.stat().st_size / 1e6:.1f} MB, {code} JIT code")


if __name__ == "__main__":
    main()
