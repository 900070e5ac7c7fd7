# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each firmware family boots to the picture that it is known for."""

from __future__ import annotations

import hashlib

import pytest

from verification.firmware.images import (
    FAMILIES,
    Family,
    ImageAbsentError,
    boot,
    digest,
    image_of,
    picture,
)

# By the image's digest: the picture's. Another image must at least run and draw something.
KNOWN = {
    "dab4fae780552324": "88fc20d560ff73fe",  # LEGO 1.29.2
    "fe6d2c70c83a1170": "88fc20d560ff73fe",  # NBC/NXC enhanced firmware 1.32
    "d1ec7b0c00e65fbf": "e13111ebe28ba97b",  # leJOS NXJ
    "71b4e4942d2d98ce": "5a77299301dce763",  # nxtOSEK
    "a35ff5ef86de06e5": "40179859d5188006",  # Pybricks 4.0.0b5
}


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_it_boots_and_draws(family: Family) -> None:
    try:
        image = image_of(family)
    except ImageAbsentError as error:
        pytest.skip(str(error))
    brick, stop = boot(family, image)
    assert stop.reason == "reached", stop.message
    assert any(brick.lcd()), "an empty picture"
    expected = family.picture or KNOWN.get(hashlib.sha256(image).hexdigest()[:16])
    if expected is not None:
        assert digest(brick) == expected, "\n" + "\n".join(picture(brick))
