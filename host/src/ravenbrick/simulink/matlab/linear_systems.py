# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Linear systems and designs in programs of MATLAB's language, computed by python-control."""

from __future__ import annotations

import operator
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from ravenbrick.model.lazy import control
from ravenbrick.simulink.expressions import Apply, Infix, Name, Prefix, Tree, parse
from ravenbrick.simulink.numbers import Workspace, evaluate

__all__ = ["LTI", "Systems", "is_lti", "lti_rate", "system_of"]

LTI = "cstblocks/LTI System"
Results = tuple[Any, ...]
_METHODS = ("zoh", "foh", "tustin", "matched")
_TEXT = re.compile(r"""["'](\w+)["']""")
_BRACES = re.compile(r"(\.(?:[nN]um|[dD]en|Numerator|Denominator))\{[1:](?:,[1:])?\}")
_MOST_STATES, _GREATEST_POWER = 200, 20
_PARTS = (("num", "Num", "Numerator"), ("den", "Den", "Denominator"))
_FIELDS = ("Ts", *"ABCDabcd", *_PARTS[0], *_PARTS[1])
_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
}  # fmt: skip


def is_lti(source: str) -> bool:
    """Whether a link leads to the block of a linear system."""
    return source.replace("\n", " ") == LTI


def lti_rate(text: str, variables: Workspace) -> float | None:
    """The sample time (s) of a linear system; None for a continuous one."""
    try:
        system = system_of(text, variables.known())
    except ValueError:
        return None
    return float(system.dt) if _is_system(system) and control.isdtime(system, strict=True) else None


def _is_system(value: Any) -> bool:
    return not isinstance(value, np.ndarray | str)


def _of_bounded_size(value: Any) -> Any:
    """A system or matrices of which a design takes no long time."""
    if isinstance(value, control.TransferFunction):
        size = max(np.size(one) for row in (*value.num, *value.den) for one in row)
    else:
        size = value.nstates if _is_system(value) else len(value)
    if size > _MOST_STATES:
        raise ValueError(f"a design with more than {_MOST_STATES} states")
    return value


def _number(value: Any) -> float:
    if _is_system(value) or np.size(value) != 1:
        raise ValueError("a number is expected")
    return float(np.ravel(value)[0])


def _state_space(a: Any, *more: Any) -> Results:
    if _is_system(a):
        return (control.ss(a),)
    b, c, d, *rate = more
    if not np.any(d):  # MATLAB takes 0 and [] for any size
        d = np.zeros((len(c), b.shape[1]))
    return (control.ss(a, b, c, d, *map(_number, rate)),)


def _transfer_function(first: Any, *more: Any) -> Results:
    if isinstance(first, str):
        return (control.tf(first, *map(_number, more)),)
    if _is_system(first):
        return (control.tf(first),)
    denominator, *rate = more
    return (control.tf(first.ravel(), denominator.ravel(), *map(_number, rate)),)


def _sampled(first: Any, *more: Any) -> Results:
    """A system and its sample time, or A, B and the sample time, with inputs held."""
    if not _is_system(first):
        entry, rate = more
        order = len(first)
        held = control.ss(first, entry, np.eye(order), np.zeros((order, entry.shape[1])))
        held = control.sample_system(held, _number(rate), "zoh")
        return held.A, held.B
    rate, method = more if len(more) == 2 else (*more, "zoh")
    if method not in _METHODS:
        raise ValueError(f"no method '{method}' of c2d")
    return (control.sample_system(first, _number(rate), method),)


def _polynomials(system: Any) -> Results:
    """Numerator and denominator as rows of one length, as MATLAB keeps them."""
    found = control.tf(system)
    if found.ninputs * found.noutputs != 1:
        raise ValueError("several inputs or outputs have no single numerator")
    rows = [np.ravel(one[0][0]) for one in (found.num, found.den)]
    size = max(map(len, rows))
    return tuple(np.pad(row, (size - len(row), 0))[np.newaxis] for row in rows)


def _matrices(system: Any) -> Results:
    found = control.ss(system)
    return found.A, found.B, found.C, found.D


def _regulator(*given: Any) -> Results:
    if _is_system(given[0]) and control.isdtime(given[0], strict=True):
        return _discrete_regulator(*given)
    return tuple(control.lqr(*filter(np.size, given)))


def _discrete_regulator(*given: Any) -> Results:
    return tuple(control.dlqr(*filter(np.size, given)))


def _placed(solve: str) -> Callable[..., Results]:
    return lambda a, b, poles: (np.atleast_2d(getattr(control, solve)(a, b, np.ravel(poles))),)


def _riccati(solve: str) -> Callable[..., Results]:
    """Solution, gain and poles of A, B, Q, R, S, E, G; `[]` is left out, and so may the last be."""

    def make(*given: Any) -> Results:
        if len(given) > 6 and np.any(given[6]):
            raise ValueError("a Riccati equation with the matrix G")
        order = len(given[0])
        found = [one if np.size(one) else None for one in given[:6]]
        found += [None] * (6 - len(found))
        if found[4] is not None and not np.any(found[4]):  # 0 counts for any size
            found[4] = None
        r = np.eye(given[1].shape[1]) if found[3] is None else found[3]
        more = []
        if found[4] is not None or found[5] is not None:
            none = np.zeros((order, given[1].shape[1]))
            more = [none if found[4] is None else found[4],
                    np.eye(order) if found[5] is None else found[5]]  # fmt: skip
        solution, poles, gain = getattr(control, solve)(*found[:3], r, *more)
        return solution, gain, poles

    return make


_FUNCTIONS: dict[str, Callable[..., Results]] = {
    "ss": _state_space, "tf": _transfer_function, "c2d": _sampled,
    "ssdata": _matrices, "tfdata": lambda system, *_: _polynomials(system),
    "lqr": _regulator, "dlqr": _discrete_regulator,
    "lqe": lambda *given: tuple(control.lqe(*given)),
    "dlqe": lambda *given: tuple(control.dlqe(*given)),
    "place": _placed("place"), "acker": _placed("place_acker"),
    "feedback": lambda *given: (control.feedback(*given),),
    "series": lambda one, two: (two * one,), "parallel": lambda one, two: (one + two,),
    "zpk": lambda zeros, poles, gain, *rate: _transfer_function(
        _number(gain) * np.poly(np.ravel(zeros))[np.newaxis]
        if np.size(zeros) else gain, np.poly(np.ravel(poles))[np.newaxis], *rate),
    "care": lambda *given: tuple(control.care(*given)),
    "icare": _riccati("care"),
    "dare": lambda *given: tuple(control.dare(*given)),
    "idare": _riccati("dare"),
    "lyap": lambda *given: (control.lyap(*given),),
    "dlyap": lambda *given: (control.dlyap(*given),),
    "ctrb": lambda a, b: (control.ctrb(a, b),), "obsv": lambda a, c: (control.obsv(a, c),),
}  # fmt: skip


class Systems:
    """The systems that a program has assigned so far, beside the numbers in `found`."""

    def __init__(self, found: Workspace) -> None:
        self._found = found
        self._known: dict[str, Any] = {}

    def assign(self, names: list[str], text: str) -> None:
        """Give names the outputs of an expression; raises `ValueError` for what is not understood.

        A name of `~` takes nothing, and none takes text or complex numbers. A system is known by
        its fields: `G.A`, `G.num`, `G.Ts`.
        """
        values = self._value(text)
        if len(names) == 2 and text.lstrip().startswith("size") and np.size(values[0]) == 2:
            values = tuple(np.array([[one]]) for one in np.ravel(values[0]))
        if len(values) < len(names):
            raise ValueError(f"{len(names)} results of an expression that has {len(values)}")
        self.forget(names)
        for name, value in zip(names, values, strict=False):
            if name == "~":
                continue
            if _is_system(value):
                self._known[name] = value
                self._found.update(_fields(name, value))
            elif isinstance(value, np.ndarray) and not np.any(np.imag(value)):
                self._found[name] = np.atleast_2d(np.real(value)).astype(float)

    def forget(self, names: list[str]) -> None:
        """These names have no value, and systems of these names no fields."""
        for name in names:
            self._found.pop(name, None)
            if self._known.pop(name, None) is not None:
                for field in _FIELDS:
                    self._found.pop(f"{name}.{field}", None)

    def know(self, name: str, system: Any) -> None:
        """A system by its name."""
        self._known[name] = system

    def value(self, text: str) -> Any:
        """The first result of an expression."""
        return self._value(text)[0]

    def _value(self, text: str) -> Results:
        """All results of an expression."""
        words: dict[str, str] = {}

        def named(match: re.Match[str]) -> str:
            words[f"text_{len(words)}"] = match[1]
            return f"text_{len(words) - 1}"

        tree = parse(_BRACES.sub(r"\1", _TEXT.sub(named, text)))
        self._words = words
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                return self._results(tree)
        except (
            ArithmeticError, AttributeError, IndexError, NotImplementedError, TypeError,
            np.linalg.LinAlgError,
        ) as error:  # fmt: skip
            raise ValueError(f"'{text}' is not understood: {error}") from error

    def _results(self, tree: Tree) -> Results:
        match tree:
            case Name(text=name) if name in self._words:
                return (self._words[name],)
            case Name(text=name) if name in self._known:
                return (self._known[name],)
            case Apply(name=name, arguments=arguments) if (
                name in _FUNCTIONS and name not in dict.keys(self._found)
            ):
                given = (_of_bounded_size(self._results(one)[0]) for one in arguments)
                return _FUNCTIONS[name](*given)
            case Infix(operator=sign, left=left, right=right):
                return (_combined(sign, self._results(left)[0], self._results(right)[0]),)
            case Prefix(operator=sign, operand=operand):
                value = self._results(operand)[0]
                if _is_system(value):
                    return (_combined("*", np.array([[-1.0 if sign == "-" else 1.0]]), value),)
                return (evaluate(Prefix(sign, Name("one")), {"one": value}),)
        return (evaluate(tree, self._found),)


def system_of(text: str, variables: Workspace) -> Any:
    """The linear system, or matrix, that an expression stands for.

    Variables that are systems are known by their fields. Raises `ValueError` for what is not
    understood.
    """
    own = Systems(Workspace(variables, guess=variables.guess))
    for name in set(re.findall(r"[A-Za-z]\w*", text)):
        system = _from_fields(name, variables)
        if system is not None:
            own.know(name, system)
    return own.value(text)


def _from_fields(name: str, variables: Workspace) -> Any:
    given = dict.keys(variables)
    rate = [_number(variables[f"{name}.Ts"])] if f"{name}.Ts" in given else []
    sampled = [one for one in rate if one > 0]
    if f"{name}.A" in given:
        return control.ss(*(variables[f"{name}.{letter}"] for letter in "ABCD"), *sampled)
    if f"{name}.num" in given:
        rows = (np.ravel(variables[f"{name}.{part}"]) for part in ("num", "den"))
        return control.tf(*rows, *sampled)
    return None


def _combined(sign: str, left: Any, right: Any) -> Any:
    """Systems in series, in parallel or as a power; otherwise numbers."""
    if not _is_system(left) and not _is_system(right):
        return evaluate(Infix(sign, Name("left"), Name("right")), {"left": left, "right": right})
    left, right = _of_bounded_size(left), _of_bounded_size(right)
    if sign == "^":
        if abs(_number(right)) > _GREATEST_POWER:
            raise ValueError(f"a system to a power above {_GREATEST_POWER}")
        return left ** round(_number(right))
    if sign not in _OPERATORS:
        raise ValueError(f"'{sign}' of a system")
    return _OPERATORS[sign](*(one if _is_system(one) else _number(one) for one in (left, right)))


def _fields(name: str, system: Any) -> dict[str, np.ndarray]:
    """What a program may read of a system."""
    rate = float(system.dt) if control.isdtime(system, strict=True) else 0.0
    found = {"Ts": np.array([[rate]])}
    if isinstance(system, control.TransferFunction):
        for words, row in zip(_PARTS, _polynomials(system), strict=True):
            found |= dict.fromkeys(words, row)
    else:
        for letter, matrix in zip("ABCD", _matrices(system), strict=True):
            found |= dict.fromkeys((letter, letter.lower()), matrix)
    return {f"{name}.{field}": value for field, value in found.items()}
