# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads the declarations of C headers: structures with their layout, variables, functions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ravenbrick.errors import DesignError

__all__ = ["NUMBERS", "Declarations", "Leaf", "Parameter", "Structure", "read_declarations"]

# Sizes in bytes of the names of rtwtypes.h and of their C99 counterparts on the brick.
NUMBERS: Mapping[str, int] = {
    **dict.fromkeys(("int8_T", "int8_t", "uint8_T", "uint8_t", "boolean_T", "bool", "char_T"), 1),
    **dict.fromkeys(("uchar_T", "byte_T", "char", "signed char", "unsigned char", "_Bool"), 1),
    **dict.fromkeys(("int16_T", "int16_t", "uint16_T", "uint16_t"), 2),
    **dict.fromkeys(("short", "unsigned short"), 2),
    **dict.fromkeys(("int32_T", "int32_t", "uint32_T", "uint32_t", "int_T", "uint_T"), 4),
    **dict.fromkeys(("int", "unsigned int", "unsigned", "long", "unsigned long"), 4),
    **dict.fromkeys(("real32_T", "float", "ulong_T"), 4),
    **dict.fromkeys(("int64_T", "int64_t", "uint64_T", "uint64_t"), 8),
    **dict.fromkeys(("real_T", "real64_T", "double", "time_T"), 8),
}
_POINTER_BYTES = 4
# What the name of a pointer's type stands for.
_POINTER = "*"
_TOKEN = re.compile(
    r"(?P<comment>/\*.*?\*/|//[^\n]*)"
    r"|(?P<directive>^[ \t]*#(?:\\\n|/\*.*?\*/|[^\n])*)"
    r"|(?P<word>[A-Za-z_]\w*)|(?P<number>\d\w*)|(?P<text>\"[^\"\n]*\")|(?P<mark>[^\s])",
    re.DOTALL | re.MULTILINE,
)
_LENGTH_DIGITS = 9
_DEPTH_MAX = 100
_FIELDS_MAX = 10_000
_OPENING, _CLOSING = ("(", "[", "{"), (")", "]", "}")
_QUALIFIERS = {"const", "volatile", "static", "register", "extern", "inline", "__inline"}


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str


@dataclass(frozen=True)
class Member:
    """A field as declared; `type_name` is empty for a structure without a name."""

    name: str
    type_name: str
    inner: Structure | None
    pointer: bool
    lengths: tuple[int, ...]
    about: str

    @property
    def count(self) -> int:
        """Number of elements."""
        count = 1
        for length in self.lengths:
            count *= length
        return count


@dataclass
class Structure:
    """A `struct`, or a `union` if `shared`; fields in order of declaration."""

    members: list[Member] = field(default_factory=list)
    shared: bool = False


@dataclass(frozen=True)
class Leaf:
    """A number, an array of numbers or a pointer inside a structure.

    `path` as C writes it (`pid.P`), `type_name` the number's type or what is pointed to, `length`
    the number of elements of an array, `about` the comment behind it.
    """

    path: str
    type_name: str
    pointer: bool
    length: int | None
    offset_bytes: int
    about: str


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function."""

    type_name: str
    pointer: bool
    name: str


@dataclass
class Declarations:
    """What headers declare, by name."""

    structures: dict[str, Structure] = field(default_factory=dict)
    aliases: dict[str, str] = field(default_factory=dict)
    variables: dict[str, Parameter] = field(default_factory=dict)
    functions: dict[str, tuple[Parameter, ...]] = field(default_factory=dict)

    def resolved(self, name: str) -> str:
        """The name behind `typedef`s."""
        seen = set()
        while name in self.aliases and name not in seen and name not in NUMBERS:
            seen.add(name)
            name = self.aliases[name]
        return name

    def structure(self, name: str) -> Structure | None:
        """The structure of that name or `typedef` name."""
        return self.structures.get(name) or self.structures.get(self.resolved(name))

    def inside(self, member: Member) -> Structure | None:
        """The structure of a field or of its elements, or to which it points, if there is one."""
        return member.inner or self.structure(member.type_name)

    def field_count(self, structure: Structure, depth: int = 0) -> int:
        """Number of fields, with those of all structures inside.

        Raises:
            DesignError: A structure holds itself, or there are too many to be a model's.
        """
        count = 0
        for member in structure.members:
            inner = None if member.pointer else self.inside(member)
            if inner is not None and depth == _DEPTH_MAX:
                raise DesignError(
                    f"field '{member.name}' of type {member.type_name or 'struct'}: a structure "
                    f"holds itself, or structures lie {_DEPTH_MAX} deep in each other; declare a "
                    "pointer, or fewer levels"
                )
            count += 1 if inner is None else 1 + self.field_count(inner, depth + 1)
            if count > _FIELDS_MAX:
                raise DesignError(
                    f"field '{member.name}' and those before it have more than {_FIELDS_MAX} "
                    "fields inside; declare arrays of numbers"
                )
        return count

    def _extent(self, member: Member) -> tuple[int, int]:
        """Size and alignment of one element in bytes."""
        if member.pointer or self.resolved(member.type_name) == _POINTER:
            return _POINTER_BYTES, _POINTER_BYTES
        inner = self.inside(member)
        if inner is not None:
            return self.extent(inner)
        size = NUMBERS.get(self.resolved(member.type_name))
        if size is None:
            raise DesignError(f"field '{member.name}' has the unknown type {member.type_name}")
        return size, size

    def extent(self, structure: Structure) -> tuple[int, int]:
        """Size and alignment of a structure in bytes, by the rules of C on the brick."""
        offset, widest = 0, 1
        for _, begin, size, alignment in self._placed(structure):
            offset, widest = max(offset, begin + size), max(widest, alignment)
        return -(-offset // widest) * widest, widest

    def _placed(self, structure: Structure) -> list[tuple[Member, int, int, int]]:
        """Each field with its offset, size and alignment."""
        offset, found = 0, []
        for member in structure.members:
            size, alignment = self._extent(member)
            begin = 0 if structure.shared else -(-offset // alignment) * alignment
            found.append((member, begin, size * member.count, alignment))
            offset = begin + size * member.count
        return found

    def leaves(self, structure: Structure, path: str = "", base: int = 0) -> list[Leaf]:
        """All numbers and pointers of a structure; an array of structures has none.

        Raises:
            DesignError: As `field_count`, or a field has an unknown type.
        """
        self.field_count(structure)
        found = []
        for member, offset, _, _ in self._placed(structure):
            own, at = f"{path}{member.name}", base + offset
            inner = self.inside(member)
            length = member.count if member.lengths else None
            if inner is None or member.pointer:
                kind = member.type_name if member.pointer else self.resolved(member.type_name)
                found.append(Leaf(own, kind, member.pointer, length, at, member.about))
            elif not member.lengths:
                found += self.leaves(inner, f"{own}.", at)
        return found


class _Reader:
    def __init__(self, text: str, file: str, into: Declarations) -> None:
        self._file = file
        self._tokens = [
            _Token(match.lastgroup or "", match.group())
            for match in _TOKEN.finditer(text)
            if match.lastgroup != "directive"
        ]
        self._place = 0
        self._found = into

    def _peek(self, ahead: int = 0) -> str:
        place = self._place
        while place < len(self._tokens):
            if self._tokens[place].kind != "comment":
                if ahead == 0:
                    return self._tokens[place].text
                ahead -= 1
            place += 1
        return ""

    def _next(self) -> str:
        while self._place < len(self._tokens):
            token = self._tokens[self._place]
            self._place += 1
            if token.kind != "comment":
                return token.text
        return ""

    def _comment(self) -> str:
        """The comment that stands next, without its marks."""
        if self._place >= len(self._tokens) or self._tokens[self._place].kind != "comment":
            return ""
        lines = self._tokens[self._place].text.strip("/").strip("*").split("\n")
        return " ".join(" ".join(line.strip().lstrip("*") for line in lines).split())

    def read(self) -> None:
        """All declarations of the text."""
        while self._peek():
            if self._peek() == "typedef":
                self._next()
                self._typedef()
            elif self._peek() in ("struct", "union") and "{" in (self._peek(1), self._peek(2)):
                self._structure()
                self._skip_statement()
            elif self._peek() in ("}", ";"):
                self._next()
            else:
                self._declaration()

    def _typedef(self) -> None:
        if self._peek() in ("struct", "union", "enum") and "{" in (self._peek(1), self._peek(2)):
            is_number = self._peek() == "enum"
            structure = self._structure()
            name = self._next()
            if is_number:
                self._found.aliases[name] = "int32_T"
            elif structure is not None:
                self._found.structures[name] = structure
            self._skip_statement()
            return
        words = self._statement()
        if len(words) < 2 or "(" in words:
            return
        for one in _declarations(words):
            if one and "[" not in one:
                alias = _POINTER if "*" in one else self._type_name(one[:-1])
                self._found.aliases[one[-1]] = alias

    def _structure(self, depth: int = 0) -> Structure | None:
        """From the word struct, union or enum to the closing brace."""
        kind = self._next()
        tag = self._next() if self._peek() != "{" else ""
        self._next()
        structure = Structure(shared=kind == "union")
        if kind == "enum":
            while self._next() not in ("}", ""):
                pass
            if tag:
                self._found.aliases[tag] = "int32_T"
            return None
        while self._peek() not in ("}", ""):
            self._member(structure, depth)
        self._next()
        if tag:
            self._found.structures[tag] = structure
        return structure

    def _member(self, structure: Structure, depth: int) -> None:
        """The fields of one declaration, which may have several: `double P, I[2], *next;`."""
        inner = None
        if self._peek() in ("struct", "union") and "{" in (self._peek(1), self._peek(2)):
            if depth == _DEPTH_MAX:
                raise DesignError(
                    f"{self._file}: structures lie {_DEPTH_MAX} deep in each other; declare fewer "
                    "levels"
                )
            inner = self._structure(depth + 1)
        words, abouts = self._noted_statement()
        if ":" in words or "(" in words:
            raise DesignError(
                f"{self._file}: the field '{' '.join(words)}' is a bit field or a function; "
                "generate the model without them"
            )
        fields = _declarations(["", *words] if inner else words)
        for one, about in zip(fields, abouts, strict=False):
            lengths = tuple(self._length(one, at) for at, word in enumerate(one) if word == "[")
            plain = _without_lengths(one)
            if len(plain) < 2 or plain[-1] == "*":
                raise DesignError(
                    f"{self._file}: a field of a structure has no name or no type: "
                    f"'{' '.join(words)}'"
                )
            type_name = "" if inner else self._type_name(plain[:-1])
            structure.members.append(
                Member(plain[-1], type_name, inner, "*" in plain, lengths, about)
            )

    def _length(self, words: Sequence[str], at: int) -> int:
        ending = words.index("]", at) if "]" in words[at:] else len(words)
        text = " ".join(words[at + 1 : ending]).rstrip("uUlL")
        if not text.isdigit() or len(text) > _LENGTH_DIGITS:
            raise DesignError(
                f"{self._file}: the length of '{words[at - 1]}' must be a number, not {text[:20]}"
            )
        return int(text)

    def _type_name(self, words: Sequence[str]) -> str:
        ignored = {*_QUALIFIERS, "struct", "union", "enum", "*"}
        return " ".join(word for word in words if word not in ignored)

    def _statement(self) -> list[str]:
        """The words to the next semicolon, which is passed."""
        words = []
        while self._peek() not in (";", ""):
            words.append(self._next())
        self._next()
        return words

    def _noted_statement(self) -> tuple[list[str], list[str]]:
        """The same, and for each of its parts between commas the comment behind it.

        A part without one has that behind the semicolon.
        """
        words: list[str] = []
        abouts: list[str] = []
        while self._peek() not in (";", ""):
            words.append(self._next())
            abouts += [self._comment()] if words[-1] == "," else []
        self._next()
        last = self._comment()
        return words, [*(about or last for about in abouts), last]

    def _skip_statement(self) -> None:
        self._statement()

    def _declaration(self) -> None:
        """Variables or a function; bodies and values are passed over."""
        words: list[str] = []
        while self._peek() not in (";", "", "{"):
            if self._peek() == "=":
                self._skip_value()
            else:
                words.append(self._next())
        if self._peek() == "{":
            if words == ["extern", '"C"']:
                self._next()
                return
            self._skip_braces()
        else:
            self._next()
        if "(" in words and words.index("(") >= 2:
            opening = words.index("(")
            groups = _between_commas(words[opening + 1 : -1])
            parameters = [self._parameter(one) for one in groups if one and one != ["void"]]
            self._found.functions[words[opening - 1]] = tuple(parameters)
        elif len(words) >= 2 and "static" not in words:
            for one in filter(None, _declarations(words)):
                if plain := _without_lengths(one):
                    self._found.variables[plain[-1]] = self._parameter(one)

    def _parameter(self, words: Sequence[str]) -> Parameter:
        plain = [word for word in words if word not in _QUALIFIERS]
        pointer = "*" in plain or "[" in plain
        plain = plain[: plain.index("[")] if "[" in plain else plain
        return Parameter(self._type_name(plain[:-1]), pointer, plain[-1] if plain else "")

    def _skip_value(self) -> None:
        """To the comma or semicolon behind the value, which stays."""
        depth = 0
        while self._peek() not in (";", "") and (depth or self._peek() != ","):
            word = self._next()
            depth += (word in _OPENING) - (word in _CLOSING)

    def _skip_braces(self) -> None:
        depth = 0
        while self._peek():
            word = self._next()
            depth += (word == "{") - (word == "}")
            if depth == 0:
                return


def _between_commas(words: Sequence[str]) -> list[list[str]]:
    """The groups of words that commas outside of brackets part."""
    groups: list[list[str]] = [[]]
    depth = 0
    for word in words:
        depth += (word in _OPENING) - (word in _CLOSING)
        if word == "," and not depth:
            groups.append([])
        else:
            groups[-1].append(word)
    return groups


def _without_lengths(words: Sequence[str]) -> list[str]:
    """The words before the first bracket."""
    return list(words[: words.index("[")] if "[" in words else words)


def _declarations(words: Sequence[str]) -> list[list[str]]:
    """`double P, *next` as declarations of one name each: `double P` and `double *next`."""
    first, *others = _between_commas(words)
    kind = [word for word in _without_lengths(first)[:-1] if word != "*"]
    return [first, *([*kind, *other] for other in others)]


def read_declarations(texts: Mapping[str, str]) -> Declarations:
    """The declarations of C texts by file name, read in order; raises `DesignError`.

    Understands what generated models are written in: structures with numbers, arrays, pointers
    and structures inside, enumerations, `typedef`, `extern`.
    """
    found = Declarations()
    for file, text in texts.items():
        _Reader(text, file, found).read()
    return found
