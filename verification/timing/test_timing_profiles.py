# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each example at the ends of the timing that no document specifies, and in all scenarios."""

from __future__ import annotations

import pytest

from verification.built_examples import build_example, ravenbrick
from verification.support.paths import ROOT
from verification.timing.examples import EXAMPLES

SCENARIOS = [
    (example, path.stem)
    for example in EXAMPLES
    for path in sorted((ROOT / "examples" / example / "scenarios").glob("*.toml"))
]
PROFILES = ("optimistic", "nominal", "pessimistic")
PEER = "remote-joystick"
pytestmark = pytest.mark.long("builds, runs and bounds every example")


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("example", [name for name in EXAMPLES if name != PEER])
def test_every_criterion_and_deadline_is_met(example: str, profile: str) -> None:
    """As with the nominal timing, whichever end the real brick is at. The joystick runs as the
    vehicle's other brick."""
    build_example(PEER)
    build_example(example)
    answer = ravenbrick(
        "run", f"examples/{example}", EXAMPLES[example], "--timing-profile", profile
    )
    assert all(criterion["met"] for criterion in answer["criteria"])
    assert all(task["deadline_misses"] == 0 for task in answer["tasks"].values())


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("example", EXAMPLES)
def test_bounds_are_above_what_is_seen_and_below_deadlines(example: str, profile: str) -> None:
    """Of execution times and of responses, both with the same timing."""
    build_example(PEER)
    build_example(example)
    options = ("--scenario", EXAMPLES[example], "--timing-profile", profile, "--no-margins")
    answer = ravenbrick("analyse", f"examples/{example}", *options)
    assert answer["schedulable"]
    for task in answer["tasks"]:
        for kind in ("execution", "response"):
            seen, bound = task["observed"][f"{kind}_cycles"], task[f"{kind}_bound_cycles"]
            assert (seen or 0) <= bound, f"{task['name']}: {kind}"


@pytest.mark.parametrize(("example", "scenario"), SCENARIOS)
def test_no_scenario_contradicts_a_fact(example: str, scenario: str) -> None:
    """Else `analyse` ends with an error."""
    build_example(PEER)
    build_example(example)
    options = ("--scenario", scenario, "--no-margins")
    answer = ravenbrick("analyse", f"examples/{example}", *options)
    assert answer["schedulable"]
