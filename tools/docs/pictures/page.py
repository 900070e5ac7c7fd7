# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The guide's pictures of the page, from the browser tests: `python -m tools.docs.pictures.page`.

The tests leave theirs in out/page; this packs them to few colours in docs/pictures/page.
`--keep` takes the pictures that are there. Needs what `make page` needs, and Chromium.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from PIL import Image

__all__ = ["MADE", "ROOT", "main", "pack_picture"]

ROOT = Path(__file__).resolve().parents[3]
MADE = ROOT / "out" / "page"
KEPT = ROOT / "docs" / "pictures" / "page"
COLOURS = 160
WIDTH = 960
# Name of the test's picture, name in the docs, height of the uppermost part that is shown (0: all).
PICTURES = (
    ("8-bounds", "driving", 900),
    ("4-by-hand", "by-hand", 900),
    ("5-faults", "faults", 0),
    ("6-stepped", "stepped", 900),
    ("9-beyond-bounds", "beyond-bounds", 900),
    ("10-line", "line", 900),
    ("7-phone-dark", "phone", 0),
)


def pack_picture(source: Path, target: Path, height: int) -> int:
    """Pack a picture to few colours, cut to a height (0: whole); its size in bytes."""
    picture = Image.open(source).convert("RGB")
    picture = picture.crop((0, 0, picture.width, min(height or picture.height, picture.height)))
    if picture.width > WIDTH:
        size = (WIDTH, round(picture.height * WIDTH / picture.width))
        picture = picture.resize(size, Image.Resampling.LANCZOS)
    target.parent.mkdir(parents=True, exist_ok=True)
    # Rare colours are kept: a missed deadline is a few red pixels.
    method = Image.Quantize.MAXCOVERAGE
    packed = picture.quantize(COLOURS, method=method, dither=Image.Dither.NONE)
    packed.save(target, optimize=True)
    return target.stat().st_size


def main(arguments: list[str]) -> int:
    """Run the tests and pack their pictures; the exit code of the tests."""
    if "--keep" not in arguments:
        done = subprocess.run(["npm", "run", "--silent", "e2e"], cwd=ROOT / "web", check=False)
        if done.returncode != 0:
            return done.returncode
    for made, name, height in PICTURES:
        size = pack_picture(MADE / f"{made}.png", KEPT / f"{name}.png", height)
        print(f"docs/pictures/page/{name}.png: {size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
