# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""ARM code of GCC that takes a word of a dispatch table and branches to it.

    ldr b, [object, #m]    the tag; m > 0 for that of an interface
    ldr t, [b, #4 * slot]
    tst t, #2              Is it a descriptor of a nested subprogram? None is in these tables.
    ldrne t, [t, #2]       or the same behind a branch
    bx t

A program may test an address that it calls in the same way, so what a descriptor holds has to be
taken after each test. An operation that each type has, such as "=", is reached over a word before
the table, so m < 0.
The instructions are looked for backwards on all ways that lead to the branch.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace

__all__ = ["DispatchCode"]

ALWAYS = 14
RETURN_ADDRESS = 0xE1A0_E00F  # mov lr, pc
# What a call may change (procedure call standard).
SCRATCH = {0, 1, 2, 3, 12, 14}
LIMIT = 2_000


def _target(address: int, word: int) -> int:
    offset = (word & 0xFF_FFFF) << 2
    return address + 8 + (offset - (1 << 26) if offset >> 25 else offset)


def _is_exchange(word: int) -> bool:
    return word & 0x0FFF_FFF0 == 0x012F_FF10


def _written(word: int) -> set[int]:
    """Registers that an instruction other than a branch may change."""
    kind, first, second = word >> 25 & 7, word >> 12 & 15, word >> 16 & 15
    if kind == 0 and word & 0x90 == 0x90:  # products, half-words
        return {first, second, first + 1}
    if kind in (0, 1):
        compares = word >> 23 & 3 == 2 and word >> 20 & 1
        return set() if compares else {first}
    if kind in (2, 3):
        based = {second} if word >> 21 & 1 or not word >> 24 & 1 else set()
        return based | ({first} if word >> 20 & 1 else set())
    if kind == 4:
        return {second} | ({n for n in range(16) if word >> n & 1} if word >> 20 & 1 else set())
    return set(range(16))


@dataclass(frozen=True)
class _Way:
    """Before which instruction a register is looked at, what is known of its flags, whether what it
    holds was taken from a descriptor after it, whether it was looked for one, and whether the
    register has to be a tag."""

    address: int
    register: int
    condition: int = ALWAYS
    is_descriptor: bool = False
    is_tested: bool = False
    is_tag: bool = False


@dataclass
class _Found:
    """Numbers of words; tests for a descriptor on a way that takes what it holds, and on others."""

    slots: set[int] = field(default_factory=set)
    taken: set[int] = field(default_factory=set)
    tests: set[int] = field(default_factory=set)


class DispatchCode:
    """Instructions of an image: its words, the addresses that are ARM code, where functions begin,
    and which of them never return."""

    def __init__(
        self,
        words: Mapping[int, int],
        code: Collection[int],
        functions: Collection[int],
        endless: Collection[int] = (),
    ) -> None:
        self._words, self._code, self._endless = words, code, endless
        # A word may be the address of an instruction, to which something jumps.
        self._unknown = {*functions, *words.values()}
        self._jumps: dict[int, list[int]] = defaultdict(list)
        for address in code:
            if words[address] >> 24 & 15 == 10:
                self._jumps[_target(address, words[address])].append(address)
            elif words[address] >> 24 & 15 == 11:
                self._unknown.add(_target(address, words[address]))

    def calls(self, begin: int, size: int) -> Iterator[tuple[int, set[int]]]:
        """Offsets of a function's branches to words of tables, and the numbers of these words."""
        for address in range(begin, begin + size, 4):
            word = self._words[address] if address in self._code else 0
            if word & 0xFFFF_FFF0 == 0xE12F_FF10 and word & 15 != 14:
                slots = self._slots(address, word & 15)
                if slots:
                    yield address - begin, slots

    def _goes_on(self, address: int) -> bool:
        """May the next instruction be executed after this one?"""
        if address not in self._code:
            return False
        word = self._words[address]
        if word >> 28 != ALWAYS:
            return True
        if _is_exchange(word):
            return self._words.get(address - 4) == RETURN_ADDRESS
        if word >> 24 & 15 == 11:
            return _target(address, word) not in self._endless
        return word >> 24 & 15 != 10 and 15 not in _written(word)

    def _before(self, address: int) -> list[tuple[int, int]]:
        """Instructions after which this one is executed, each with the condition that then holds;
        none if not all are known."""
        if address in self._unknown:
            return []
        found = [(jump, self._words[jump] >> 28) for jump in self._jumps.get(address, [])]
        if self._goes_on(address - 4):
            word = self._words[address - 4]
            skips = word >> 24 & 15 == 10  # else the instruction is executed or not
            found.append((address - 4, word >> 28 ^ 1 if skips else ALWAYS))
        return found

    def _slots(self, branch: int, register: int) -> set[int] | None:
        """Numbers of words that a register may hold; None if it may hold something else."""
        found = _Found()
        ways = [_Way(branch, register)]
        seen: set[_Way] = set()
        while ways:
            way = ways.pop()
            if way in seen:
                continue
            seen.add(way)
            before = self._before(way.address)
            if not before or len(seen) > LIMIT:
                return None
            for address, condition in before:
                if condition != ALWAYS and way.condition == condition ^ 1:
                    continue
                holds = way.condition if condition == ALWAYS else condition
                more = self._backwards(replace(way, address=address, condition=holds), found)
                if more is None:
                    return None
                ways += more
        return found.slots if found.tests == found.taken else None

    def _backwards(self, way: _Way, found: _Found) -> list[_Way] | None:
        """Ways on before the instruction of a way; what it is goes into `found`."""
        word, register = self._words[way.address], way.register
        condition, form, base = word >> 28, word & 0x0FFF_FFFF, word >> 16 & 15
        if word >> 24 & 15 == 10:
            return [way]
        if word >> 24 & 15 == 11 or _is_exchange(word):
            return None if register in SCRATCH else [replace(way, condition=ALWAYS)]
        if word >> 26 & 3 == 0 and word >> 20 & 1:  # sets the flags
            way = replace(way, condition=ALWAYS)
        tested = word & 0xFFE0_0FFF == 0xE200_0002 or word & 0xFFF0_0FFF == 0xE310_0002
        if tested and base == register and not way.is_tag:
            (found.taken if way.is_descriptor else found.tests).add(way.address)
            way = replace(way, is_tested=True)
        never = condition != ALWAYS and way.condition == condition ^ 1
        if never or register not in _written(word):
            return [way]
        skipped = []
        if condition not in (ALWAYS, way.condition):
            skipped = [replace(way, condition=condition ^ 1)]
        way = replace(way, condition=way.condition if condition == ALWAYS else condition)
        if form & 0x0FFF_FFF0 == 0x01A0_0000 | register << 12:
            return [*skipped, replace(way, register=word & 15)]
        if form == 0x0590_0002 | base << 16 | register << 12 and not way.is_tested:
            return [*skipped, replace(way, register=base, is_descriptor=True)]
        if form & 0x0FF0_F003 != 0x0590_0000 | register << 12 or base == 15:
            return None
        if way.is_tag:
            return skipped
        if not way.is_tested:
            return None
        found.slots.add((word & 0xFFF) // 4)
        return [*skipped, replace(way, register=base, is_tag=True)]
