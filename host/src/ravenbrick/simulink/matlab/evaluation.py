# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs in MATLAB's language as blocks: loops are unrolled, branches become choices."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ravenbrick.model import UnitDelay
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.expressions import Apply, Infix, Name, Prefix, Rows, Span, Tree, parse
from ravenbrick.simulink.matlab.arrays import Arrays, array_of, is_constant
from ravenbrick.simulink.matlab.statements import (
    Assign,
    Branches,
    Function,
    Loop,
    Persistent,
    Statement,
    functions,
)
from ravenbrick.simulink.numbers import Variables, Workspace, evaluate, places
from ravenbrick.simulink.signals import Node, Wire

__all__ = ["Program", "formula", "program_of"]

_DEEPEST = 20
_MOST_BLOCKS = 20_000
_MOST_TURNS = 1000
Find = Callable[[str], str | None]


def formula(b: Builder, text: str, signals: Mapping[str, list[Wire]]) -> Wire:
    """The first element of a formula of signals."""
    arrays = {name: array_of(list(wires), len(wires), 1) for name, wires in signals.items()}
    scope = _Scope(Program(b, lambda _: None), arrays, b.site.variables)
    with b.sharing():
        return b.element(scope.value(parse(text))[0, 0])


def program_of(text: str, name: str) -> Mapping[str, Function]:
    """The functions of a file `name`; raises `ValueError` with file and line."""
    try:
        return functions(text)
    except ValueError as error:
        text = re.sub(r"^line (\d+): ", r"\1: ", str(error))
        raise ValueError(f"{name}:{text}") from error


@dataclass
class Program:
    """What is known while blocks are made of one block's program.

    `find` gives the text of the file of a function, None for one that there is no file of.
    """

    b: Builder
    find: Find
    depth: int = 0
    files: dict[str, Mapping[str, Function]] = field(default_factory=dict)

    def value(self, text: str, signals: Mapping[str, np.ndarray]) -> np.ndarray:
        """An expression of signals and of variables of the workspace."""
        tree = parse(text)
        if isinstance(tree, Name) and tree.text not in signals:
            tree = Apply(tree.text, tuple(Name(name) for name in signals))
        with self.b.sharing():
            return _Scope(self, dict(signals), self.b.site.variables).value(tree)

    def call(
        self, function: Function, given: list[np.ndarray], file: str, known: Variables | None = None
    ) -> list[np.ndarray]:
        """The outputs of a function; `known` are parameters besides its inputs."""
        if len(given) > len(function.inputs):
            raise ValueError(
                f"'{function.name}' has {len(function.inputs)} inputs, {len(given)} are given"
            )
        if self.depth > _DEEPEST:
            raise ValueError(f"functions call each other more than {_DEEPEST} deep")
        scope = _Scope(self, dict(zip(function.inputs, given, strict=False)), known or {}, file)
        self.depth += 1
        with self.b.sharing():
            scope.run(function.body)
            scope.keep()
        self.depth -= 1
        return [scope.result(name) for name in function.outputs]

    def function(self, name: str, file: str) -> tuple[Function, str] | None:
        """A function of the same file, or the first one of its own file, with the file's name."""
        own = self.files.get(file, {}).get(name)
        if own is not None:
            return own, file
        other = f"{name}.m"
        if other not in self.files:
            text = self.find(name)
            self.files[other] = {} if text is None else program_of(text, other)
        first = next(iter(self.files[other].values()), None)
        return None if first is None else (first, other)


class _Scope:
    """The variables of one call."""

    def __init__(
        self, program: Program, values: dict[str, np.ndarray], known: Variables, file: str = ""
    ) -> None:
        self.arrays = Arrays(program.b)
        self._program = program
        self._values = values
        self._known = known
        # Without those that a workspace guesses.
        self._given = frozenset(known)
        self._file = file
        self._fresh: set[str] = set()
        self._kept: dict[str, list[Node]] = {}

    def result(self, name: str) -> np.ndarray:
        """An output; raises `ValueError` if nothing was assigned to it."""
        if name not in self._values:
            raise ValueError(f"{self._file}: nothing is assigned to the output '{name}'")
        return self._values[name]

    def _constants(self) -> Workspace:
        numbers = {name: array for name, array in self._values.items() if is_constant(array)}
        guess = isinstance(self._known, Workspace) and self._known.guess
        return Workspace({**self._known, **numbers}, guess=guess)

    def _is_signal(self, tree: Tree) -> bool:
        """Whether an expression needs signals or functions of files."""
        match tree:
            case Name(text=name) | Apply(name=name) if name in self._values:
                inner = tree.arguments if isinstance(tree, Apply) else ()
                constant = is_constant(self._values[name])
                return not constant or any(map(self._is_signal, inner))
            case Name(text=name):
                return name not in self._known and self._function(name) is not None
            case Apply(name=name, arguments=arguments):
                return (name not in self._given and self._function(name) is not None) or any(
                    map(self._is_signal, arguments)
                )
            case Prefix(operand=operand):
                return self._is_signal(operand)
            case Infix(left=left, right=right):
                return self._is_signal(left) or self._is_signal(right)
            case Span(first=first, step=step, last=last):
                return any(map(self._is_signal, (first, step, last)))
            case Rows(rows=rows):
                return any(self._is_signal(one) for row in rows for one in row)
        return False

    def _function(self, name: str) -> tuple[Function, str] | None:
        return self._program.function(name, self._file)

    def value(self, tree: Tree) -> np.ndarray:
        """An expression as an array."""
        if len(self._program.b.nodes) > _MOST_BLOCKS:
            raise ValueError(f"a program of more than {_MOST_BLOCKS} blocks")
        if not self._is_signal(tree):
            return evaluate(tree, self._constants())
        match tree:
            case Name(text=name) if name in self._values:
                return self._values[name]
            case Name(text=name):
                return self._called(name, [])[0]
            case Apply(name=name, arguments=arguments) if name in self._values:
                return self._elements(self._values[name], arguments)
            case Apply(name=name, arguments=arguments):
                given = [self.value(one) for one in arguments]
                if self._function(name) is not None:
                    return self._called(name, given)[0]
                return self.arrays.call(name, given)
            case Prefix(operator=operator, operand=operand):
                return self._prefixed(operator, self.value(operand))
            case Infix(operator=operator, left=left, right=right):
                return self.arrays.infix(operator, self.value(left), self.value(right))
            case Rows(rows=rows):
                return _joined([[self.value(one) for one in row] for row in rows])
        raise ValueError("a range whose ends are signals")

    def _prefixed(self, operator: str, array: np.ndarray) -> np.ndarray:
        if operator == "'":
            return array.T
        if operator == "+":
            return array
        if operator == "~":
            return self.arrays.call("not", [array])
        return self.arrays.infix("*", np.array([[-1.0]]), array)

    def _elements(self, array: np.ndarray, arguments: tuple[Tree, ...]) -> np.ndarray:
        if any(one != Name(":") and self._is_signal(one) for one in arguments):
            raise ValueError("an index that is a signal; use a Selector or a MultiPortSwitch")
        found = places(array.shape, arguments, self._constants())
        if len(found) > 1:
            for size, one in zip(array.shape, found, strict=True):
                if one.max(initial=-1) >= size:
                    sizes = f"{array.shape[0]} x {array.shape[1]}"
                    raise ValueError(f"row or column {one.max() + 1} of a matrix of {sizes}")
            chosen = array[np.ix_(*found)]
            return array_of(list(chosen.ravel(order="F")), *chosen.shape)
        flat = array.ravel(order="F")
        if found[0].size and found[0].max() >= flat.size:
            raise ValueError(f"element {found[0].max() + 1} of {flat.size}")
        chosen = [flat[place] for place in found[0]]
        row = array.shape[0] == 1 and arguments[0] != Name(":")
        return array_of(chosen, *((1, len(chosen)) if row else (len(chosen), 1)))

    def _called(self, name: str, given: list[np.ndarray]) -> list[np.ndarray]:
        found = self._function(name)
        assert found is not None
        outputs = self._program.call(found[0], given, found[1])
        if not outputs:
            raise ValueError(f"the function '{name}' has no output")
        return outputs

    def run(self, body: tuple[Statement, ...]) -> None:
        """Statements one after the other; raises `ValueError` with file and line."""
        for statement in body:
            try:
                self._run(statement)
            except (ValueError, IndexError) as error:
                raise ValueError(f"{self._file}:{statement.line}: {error}") from error

    def _run(self, statement: Statement) -> None:
        match statement:
            case Assign():
                self._assign(statement)
            case Branches():
                self._branch(statement)
            case Loop(name=name, values=values, body=body):
                array = self.value(values)
                if not is_constant(array) or array.shape[1] > _MOST_TURNS:
                    raise ValueError(f"a loop whose turns are signals, or over {_MOST_TURNS}")
                for column in array.T:
                    self._values[name] = column[:, np.newaxis]
                    self.run(body)
            case Persistent(names=names):
                for name in names:
                    self._values[name] = np.zeros((0, 0))
                self._fresh |= set(names)

    def _assign(self, statement: Assign) -> None:
        targets, tree = statement.targets, statement.value
        if len(targets) == 1:
            self._set(targets[0], self.value(tree))
            return
        name = tree.name if isinstance(tree, Apply) else ""
        given = [self.value(one) for one in tree.arguments] if isinstance(tree, Apply) else []
        if name == "size":
            found = [np.array([[float(size)]]) for size in given[0].shape]
        elif self._function(name) is not None:
            found = self._called(name, given)
        else:
            raise ValueError(f"several outputs of the function '{name}'")
        for target, array in zip(targets, found, strict=False):
            if target != Name("~"):
                self._set(target, array)

    def _set(self, target: Tree, array: np.ndarray) -> None:
        if isinstance(target, Name):
            self._values[target.text] = array
            return
        assert isinstance(target, Apply)
        if any(one != Name(":") and self._is_signal(one) for one in target.arguments):
            raise ValueError("an index that is a signal; use an Assignment")
        old = self._values.get(target.name, np.zeros((0, 0)))
        self._values[target.name] = _replaced(old, target.arguments, array, self._constants())

    def _branch(self, statement: Branches) -> None:
        """The branch of a condition that is known; else choices of what the branches assign."""
        for place, (test, body) in enumerate(statement.cases):
            truth = 1.0 if test is None else self.arrays.truth(self.value(test))
            if isinstance(truth, float | int):
                if truth:
                    self.run(body)
                    self._begin()
                    return
                continue
            rest = Branches(statement.line, statement.cases[place + 1 :])
            before = dict(self._values)
            self.run(body)
            yes, self._values = self._values, before
            self._branch(rest)
            self._values = self._merged(truth, yes, self._values)
            return

    def _merged(
        self, test: Wire, yes: dict[str, np.ndarray], no: dict[str, np.ndarray]
    ) -> dict[str, np.ndarray]:
        found = {**no, **yes}
        for name in yes.keys() & no.keys():
            one, two = yes[name], no[name]
            if one is two:
                continue
            if one.shape != two.shape:
                raise ValueError(f"the branches give '{name}' different sizes")
            found[name] = self.arrays.each(
                lambda x, y: self.arrays.chosen(test, x, y), one.astype(object), two.astype(object)
            )
        return found

    def _begin(self) -> None:
        """Persistent variables that have their first values become states."""
        b = self._program.b
        for name in sorted(self._fresh):
            array = self._values[name]
            if array.size == 0:
                continue
            if not is_constant(array):
                raise ValueError(f"the first value of '{name}' is a signal")
            self._fresh.discard(name)
            nodes = [b.add(UnitDelay("B", initial=float(one)), ending=f"_{name}")
                     for one in array.ravel(order="F")]  # fmt: skip
            self._kept[name] = nodes
            self._values[name] = array_of(list(nodes), *array.shape)

    def keep(self) -> None:
        """The states take the values that the persistent variables have at the end."""
        if self._fresh:
            raise ValueError(
                f"{self._file}: the persistent variable '{min(self._fresh)}' has no first value; "
                f"assign it in 'if isempty({min(self._fresh)})'"
            )
        for name, nodes in self._kept.items():
            elements = list(self._values[name].ravel(order="F"))
            for node, element in zip(nodes, elements, strict=True):
                node.inputs = [self._program.b.element(element)]


def _joined(rows: list[list[np.ndarray]]) -> np.ndarray:
    """A matrix in brackets."""
    try:
        lines = [np.hstack([one.astype(object) for one in row if one.size]) for row in rows]
        whole = np.vstack(lines)
    except ValueError as error:
        raise ValueError("the rows of a matrix have different lengths") from error
    return array_of(list(whole.ravel(order="F")), *whole.shape)


def _replaced(
    old: np.ndarray, arguments: tuple[Tree, ...], array: np.ndarray, known: Workspace
) -> np.ndarray:
    """An array with elements replaced; it grows as far as their places need, filled with 0."""
    shape = old.shape
    if len(arguments) == 1:
        column = shape[1] == 1 and shape[0] > 1
        place = places((1, old.size) if not old.size else shape, arguments, known)[0]
        most = int(place.max(initial=-1)) + 1
        if most > old.size:
            if min(shape) > 1:
                raise ValueError("a matrix cannot grow by one index")
            shape = (most, 1) if column else (1, most)
    else:
        whole = tuple(array.shape if not old.size else shape)
        chosen = places(whole, arguments, known)
        shape = tuple(max(size, int(one.max(initial=-1)) + 1)
                      for size, one in zip(shape, chosen, strict=True))  # fmt: skip
    new = np.zeros(shape, dtype=object)
    new[:] = 0.0
    new[: old.shape[0], : old.shape[1]] = old
    if len(arguments) == 1:
        flat = new.ravel(order="F")
        flat[place] = list(array.ravel(order="F")) if array.size > 1 else array[0, 0]
        new = flat.reshape(shape, order="F")
    else:
        new[np.ix_(*chosen)] = array
    return array_of(list(new.ravel(order="F")), *shape)
