# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The guide's picture of the studio, from its browser test: `python -m tools.docs.pictures.studio`.

`--keep` takes the picture that is there. Needs what `make page` needs, and Chromium.
"""

from __future__ import annotations

import subprocess
import sys

from tools.docs.pictures.page import MADE, ROOT, pack_picture

__all__ = ["main"]


def main(arguments: list[str]) -> int:
    """Run the test and pack its picture; the exit code of the test."""
    if "--keep" not in arguments:
        command = ["npm", "run", "--silent", "e2e", "--", "e2e/studio.test.ts"]
        done = subprocess.run(command, cwd=ROOT / "web", check=False)
        if done.returncode != 0:
            return done.returncode
    target = ROOT / "docs" / "pictures" / "studio" / "error.png"
    size = pack_picture(MADE / "studio-error.png", target, 0)
    print(f"{target.relative_to(ROOT)}: {size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
