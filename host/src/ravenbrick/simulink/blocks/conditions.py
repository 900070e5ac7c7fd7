# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""If, switch case, merge, outputs of conditional subsystems, and formulas of signals."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from ravenbrick.model import Abs, ArcTangent, Merge, RoundingFunction, Sign, SquareRoot
from ravenbrick.model import Trigonometry as Wave
from ravenbrick.simulink.blocks.functions import exponential, logarithm, power
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.expressions import Apply, Infix, Name, Prefix, Rows, Tree, parse
from ravenbrick.simulink.numbers import evaluate
from ravenbrick.simulink.signals import Wire, plain, size_of

__all__ = ["CONDITIONS", "formula", "held_output", "triggered"]

_TESTS = ("==", "~=", "<", "<=", ">", ">=")
_LOGIC = {"&": "AND", "&&": "AND", "|": "OR", "||": "OR"}


def formula(b: Builder, tree: Tree, signals: Mapping[str, list[Wire]]) -> Wire:
    """The nodes that compute a formula; `signals` are its variables."""
    if not _uses(tree, signals):
        return b.constant(float(evaluate(tree, b.site.variables)[0, 0]))
    match tree:
        case Name(text=name):
            return signals[name][0]
        case Apply(name=name, arguments=arguments) if name in signals:
            place = int(evaluate(arguments[0], b.site.variables)[0, 0]) - 1
            if not 0 <= place < len(signals[name]):
                raise ValueError(f"{name}({place + 1}) of {len(signals[name])} elements")
            return signals[name][place]
        case Apply(name=name, arguments=arguments):
            return _call(b, name, [formula(b, one, signals) for one in arguments])
        case Prefix(operator=operator, operand=operand):
            value = formula(b, operand, signals)
            if operator == "~":
                return b.logic("NOT", value)
            return b.scaled(-1.0, value) if operator == "-" else value
        case Infix(operator=operator, left=left, right=right):
            return _infix(b, operator, left, right, signals)
        case _:
            raise ValueError("a formula with ranges or matrices")


def _uses(tree: Tree, signals: Mapping[str, list[Wire]]) -> bool:
    match tree:
        case Name(text=name):
            return name in signals
        case Apply(name=name, arguments=arguments):
            return name in signals or any(_uses(one, signals) for one in arguments)
        case Prefix(operand=operand):
            return _uses(operand, signals)
        case Infix(left=left, right=right):
            return _uses(left, signals) or _uses(right, signals)
        case Rows(rows=rows):
            return any(_uses(one, signals) for row in rows for one in row)
        case _:
            return False


def _infix(
    b: Builder, operator: str, left: Tree, right: Tree, signals: Mapping[str, list[Wire]]
) -> Wire:
    first = formula(b, left, signals)
    if operator == "^":
        if _uses(right, signals):
            return power(b, first, formula(b, right, signals))
        exponent = float(evaluate(right, b.site.variables)[0, 0])
        if exponent not in (2.0, 3.0, 4.0):
            return power(b, first, b.constant(exponent))
        return b.product(*[first] * int(exponent))
    second = formula(b, right, signals)
    if operator in _TESTS:
        return b.compare(first, operator, second)
    if operator in _LOGIC:
        return b.logic(_LOGIC[operator], first, second)
    if operator in "*/":
        return b.product(first, second, operators=f"*{operator}")
    return b.sum(first, second, signs=f"+{operator}")


def _call(b: Builder, name: str, given: list[Wire]) -> Wire:
    blocks = {
        "abs": Abs("B"), "sgn": Sign("B"), "sign": Sign("B"), "sqrt": SquareRoot("B"),
        "floor": RoundingFunction("B"), "ceil": RoundingFunction("B", function="ceil"),
        "sin": Wave("B"), "cos": Wave("B", function="cos"), "atan2": ArcTangent("B"),
    }  # fmt: skip
    if name == "pow" and len(given) == 2:
        return power(b, *given)
    if name in ("exp", "log", "ln") and len(given) == 1:
        return exponential(b, given[0]) if name == "exp" else logarithm(b, given[0])
    if name == "log10" and len(given) == 1:
        return b.scaled(1 / math.log(10), logarithm(b, given[0]))
    if name not in blocks or len(given) != len(blocks[name].input_types):
        raise ValueError(f"the function '{name}'")
    return b.add(blocks[name], *given, ending=f"_{name}")


def function(b: Builder) -> None:
    """A block Fcn: a formula of `u`, `u(1)`, `u[1]`."""
    text = re.sub(r"\bu\s*\[\s*(\d+)\s*\]", r"u(\1)", b.dialog().text("Expr", "u"))
    b.out([formula(b, parse(text), {"u": b.inputs()})])


def _if(b: Builder) -> None:
    d = b.dialog()
    signals = {f"u{port}": b.inputs(port) for port in range(1, b.ports() + 1)}
    texts = [d.text("IfExpression", "u1 > 0")]
    texts += [text for text in d.text("ElseIfExpressions").split(",") if text.strip()]
    tests = [formula(b, parse(text), signals) for text in texts]
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


def inverse(b: Builder, name: str, wire: Wire) -> Wire:
    """asin or acos by the arc tangent."""
    one = b.constant(1.0)
    inside = b.sum(one, b.product(wire, wire), signs="+-")
    other = b.add(SquareRoot("B"), inside, ending="_root")
    pair = (wire, other) if name == "asin" else (other, wire)
    return b.add(ArcTangent("B"), *pair, ending="_angle")


def _trigonometry(b: Builder) -> None:
    kind = b.dialog().text("Operator", b.dialog().text("Function", "sin"))
    if kind == "sincos":
        b.out([_call(b, "sin", [wire]) for wire in b.inputs()])
        b.out([_call(b, "cos", [wire]) for wire in b.inputs()], 2)
        return
    found: list[Wire] = []
    if kind == "atan2":
        width = b.width()
        pairs = zip(b.inputs(1, width), b.inputs(2, width), strict=True)
        found = [b.add(ArcTangent("B"), high, wide) for high, wide in pairs]
    for wire in () if kind == "atan2" else b.inputs():
        if kind in ("sin", "cos"):
            found.append(b.add(Wave("B", function=kind), wire))
        elif kind == "tan":
            waves = _call(b, "sin", [wire]), _call(b, "cos", [wire])
            found.append(b.product(*waves, operators="*/"))
        elif kind in ("asin", "acos"):
            found.append(inverse(b, kind, wire))
        elif kind == "atan":
            found.append(b.add(ArcTangent("B"), wire, b.constant(1.0)))
        else:
            raise ValueError(f"the function '{kind}'")
    b.out(found)


def _math(b: Builder) -> None:
    kind = b.dialog().text("Operator", b.dialog().text("Function", "exp"))
    width = b.width()
    if kind in ("transpose", "hermitian"):
        _transpose(b)
        return
    if kind in ("mod", "rem"):
        rounding = RoundingFunction("B", function="floor" if kind == "mod" else "fix")
        pairs = zip(b.inputs(1, width), b.inputs(2, width), strict=True)
        b.out([_remainder(b, rounding, *pair) for pair in pairs])
        return
    one: dict[str, Callable[[Wire], Wire]] = {
        "square": lambda wire: b.product(wire, wire),
        "magnitude^2": lambda wire: b.product(wire, wire),
        "reciprocal": lambda wire: b.product(b.constant(1.0), wire, operators="*/"),
        "sqrt": lambda wire: b.add(SquareRoot("B"), wire),
        "conj": lambda wire: wire,
        "exp": lambda wire: exponential(b, wire),
        "log": lambda wire: logarithm(b, wire),
        "10^u": lambda wire: exponential(b, b.scaled(math.log(10), wire)),
        "log10": lambda wire: b.scaled(1 / math.log(10), logarithm(b, wire)),
    }
    if kind == "pow":
        pairs = zip(b.inputs(1, width), b.inputs(2, width), strict=True)
        b.out([power(b, *pair) for pair in pairs])
        return
    if kind == "hypot":
        pairs = zip(b.inputs(1, width), b.inputs(2, width), strict=True)
        squares = [b.sum(b.product(x, x), b.product(y, y)) for x, y in pairs]
        b.out([b.add(SquareRoot("B"), wire) for wire in squares])
        return
    if kind not in one:
        raise ValueError(f"the function '{kind}'")
    b.out([one[kind](wire) for wire in b.inputs()])


def _remainder(b: Builder, rounding: RoundingFunction, top: Wire, bottom: Wire) -> Wire:
    whole = b.add(rounding, b.product(top, bottom, operators="*/"), ending="_whole")
    rest = b.sum(top, b.product(bottom, whole), signs="+-")
    return b.choose(b.compare(bottom, "~=", 0.0), rest, top)


def _transpose(b: Builder) -> None:
    shape, wires = plain(b.input_shape()), b.inputs()
    rows = shape[0] if len(shape) == 2 else len(wires)
    columns = math.ceil(len(wires) / rows)
    b.out([wires[column * rows + row] for row in range(rows) for column in range(columns)])


def _square_root(b: Builder) -> None:
    kind = b.dialog().text("Operator", "sqrt")
    if kind not in ("sqrt", "signedSqrt", "rSqrt"):
        raise ValueError(f"the function '{kind}'")
    found: list[Wire] = []
    for wire in b.inputs():
        size = b.add(Abs("B"), wire, ending="_size") if kind == "signedSqrt" else wire
        root: Wire = b.add(SquareRoot("B"), size)
        if kind == "signedSqrt":
            root = b.product(root, b.add(Sign("B"), wire, ending="_sign"))
        if kind == "rSqrt":
            root = b.product(b.constant(1.0), root, operators="*/")
        found.append(root)
    b.out(found)


CONDITIONS: Mapping[str, Callable[[Builder], None]] = {
    "Fcn": function,
    "If": _if,
    "Math": _math,
    "Merge": _merge,
    "Sqrt": _square_root,
    "SwitchCase": _switch_case,
    "Trigonometry": _trigonometry,
}
