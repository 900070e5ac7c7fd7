# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""If, switch case, merge, and outputs of conditional subsystems."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ravenbrick.model import Merge, RoundingFunction
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.expressions import Rows, parse
from ravenbrick.simulink.matlab.evaluation import formula
from ravenbrick.simulink.numbers import evaluate
from ravenbrick.simulink.signals import Wire, size_of

__all__ = ["CONDITIONS", "held_output", "triggered"]


def _if(b: Builder) -> None:
    d = b.dialog()
    signals = {f"u{port}": b.inputs(port) for port in range(1, b.ports() + 1)}
    texts = [d.text("IfExpression", "u1 > 0")]
    texts += [text for text in d.text("ElseIfExpressions").split(",") if text.strip()]
    tests = [formula(b, text, signals) for text in texts]
    _branches(b, tests, d.text("ShowElse", "on") == "on")


def _branches(b: Builder, tests: list[Wire], with_else: bool) -> None:
    """Each branch is on if its test is the first that holds."""
    before: list[Wire] = []
    for port, test in enumerate(tests, 1):
        b.out([b.logic("AND", test, *before)], port)
        before.append(b.logic("NOT", test))
    if with_else:
        b.out([b.logic("AND", *before)], len(tests) + 1)


def _switch_case(b: Builder) -> None:
    d = b.dialog()
    tree = parse(d.text("CaseConditions", "{1}"))
    cases = tree.rows[0] if isinstance(tree, Rows) and tree.rows else (tree,)
    value = b.add(RoundingFunction("B", function="fix"), b.inputs(1)[0], ending="_whole")
    tests = []
    for case in cases:
        numbers = evaluate(case, b.site.variables).ravel()
        same = [b.compare(value, "==", float(number)) for number in numbers]
        tests.append(same[0] if len(same) == 1 else b.logic("OR", *same))
    _branches(b, tests, d.text("ShowDefaultCase", "on") == "on")


def _merge(b: Builder) -> None:
    """Outputs of conditional subsystems: that of the one which runs, else the last value."""
    count = b.ports()
    width = max(size_of(b.input_shape(port)) for port in range(1, count + 1))
    initial = b.dialog().number("InitialOutput", "0") if _given(b, "InitialOutput") else 0.0
    parts: list[tuple[Wire, list[Wire]]] = []
    for port in range(1, count + 1):
        end = b.network.source(b.site.path, port)
        assert end is not None
        site = b.network.sites[end[0]]
        if site.kind == "Merge":
            guard = site.system
        elif site.kind == "Outport" and site.system:
            guard = site.system
        else:
            raise ValueError(f"input {port} comes from no conditional subsystem")
        parts.append((b.condition(guard), b.inputs(port, width)))
    found: list[Wire] = []
    for element in range(width):
        pairs = [wire for test, wires in parts for wire in (test, wires[element])]
        found.append(b.add(Merge("B", ports=len(pairs), initial=initial), *pairs))
    b.out(found)


def _given(b: Builder, name: str) -> bool:
    return b.dialog().text(name) not in ("", "[]")


def held_output(b: Builder) -> None:
    """An outport of a conditional subsystem: held, or put back, while the subsystem rests."""
    test = b.condition(b.site.system)
    found: list[Wire] = []
    for element, wire in enumerate(b.inputs()):
        d = b.dialog(element=element)
        initial = d.number("InitialOutput", "0") if _given(b, "InitialOutput") else 0.0
        if d.text("OutputWhenDisabled", "held") == "reset":
            found.append(b.choose(test, wire, b.constant(initial)))
        else:
            found.append(b.add(Merge("B", ports=2, initial=initial), test, wire))
    b.out(found)


def triggered(b: Builder, wires: list[Wire], kind: str) -> Wire:
    """1 in the steps in which a trigger fires: a change of sign, or a call."""
    if kind == "function-call":
        return b.compare(wires[0], ">", 0.5)
    tests = []
    for wire in wires:
        now = b.compare(wire, ">" if kind != "falling" else "<", 0.0)
        before = b.logic("NOT", b.last(now, initial=1.0))
        tests.append(b.logic("AND", now, before))
        if kind == "either":
            low = b.compare(wire, "<=", 0.0)
            tests.append(b.logic("AND", low, b.logic("NOT", b.last(low, initial=1.0))))
    return tests[0] if len(tests) == 1 else b.logic("OR", *tests)


CONDITIONS: Mapping[str, Callable[[Builder], None]] = {
    "If": _if,
    "Merge": _merge,
    "SwitchCase": _switch_case,
}
