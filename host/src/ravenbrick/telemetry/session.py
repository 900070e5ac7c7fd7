# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The host's side of the conversation; knows no device: bytes in, bytes out, time given.

A session outlives connections: after a loss `connected` begins again and what is known stays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ravenbrick.errors import UsageError
from ravenbrick.telemetry import messages
from ravenbrick.telemetry.frames import FRAME_END, FrameReader, frame
from ravenbrick.telemetry.log import RunLog

__all__ = ["Session", "VersionError"]

KEEP_ALIVE_S = 1.0
"""How often the host speaks when it has nothing to say; the brick waits three times as long."""

_RETRY_S = 0.5
# A thousand years after power-on; later instants do not fit into a log.
_LATEST_US = 1 << 55


class VersionError(UsageError):
    """The program on the brick speaks another version of the protocol."""


@dataclass
class _Request:
    """A change that has not been answered yet."""

    value: float
    sent_at_s: float | None = None


@dataclass
class Session:
    """State of the conversation; `on_message` hears every message that arrives."""

    on_message: Callable[[messages.Message], None] = lambda _message: None
    runs: list[RunLog] = field(default_factory=list)
    parameters: dict[int, messages.ParameterDescription] = field(default_factory=dict)
    values: dict[int, float] = field(default_factory=dict)
    answers: list[messages.Answer] = field(default_factory=list)
    status: messages.Status = field(default_factory=lambda: messages.Status(0, 0, 0))
    unknown: int = 0
    _reader: FrameReader = field(default_factory=FrameReader)
    _hello: messages.Hello | None = None
    _signals_known: set[tuple[int, int]] = field(default_factory=set)
    _requests: dict[str, _Request] = field(default_factory=dict)
    _spoke_at_s: float = 0.0
    _asked_at_s: float | None = None

    @property
    def damaged(self) -> int:
        """Frames that arrived with a wrong check value, or that were none."""
        return self._reader.damaged

    @property
    def described(self) -> bool:
        """Whether all signals and parameters of the program are known."""
        hello = self._hello
        return hello is not None and (
            len(self._signals_known) == hello.signal_count
            and len(self.parameters) == hello.parameter_count
        )

    @property
    def run(self) -> RunLog | None:
        """Samples since the brick's last start."""
        return self.runs[-1] if self.runs else None

    def connected(self, now_s: float) -> bytes:
        """A connection exists: what to send first. An end parts it from what came before."""
        self._reader.restart()
        self._hello = None
        for request in self._requests.values():
            request.sent_at_s = None
        self._asked_at_s = now_s
        return FRAME_END + self._say(messages.Ask(), now_s)

    def set_parameter(self, name: str, value: float) -> None:
        """Request a parameter's change; sent when the brick has described it, and again if lost.

        The brick checks the limits once more. Raises `UsageError` for a value outside them, or an
        unknown name once all are known.
        """
        known = {p.name: p for p in self.parameters.values()}
        if self.described and name not in known:
            names = ", ".join(sorted(known)) or "none"
            raise UsageError(f"the program has no parameter '{name}'; it has: {names}")
        if name in known:
            limits = known[name]
            if not limits.minimum <= value <= limits.maximum:
                raise UsageError(
                    f"{name} = {value:g} is outside {limits.minimum:g} to {limits.maximum:g}"
                    f"{' ' + limits.unit if limits.unit else ''}, the limits on the brick"
                )
        self._requests[name] = _Request(value)

    def pending(self, now_s: float) -> bytes:
        """Messages that are due now; often empty."""
        out = b""
        if self._asked_at_s is not None and not self.described:
            if now_s - self._asked_at_s >= _RETRY_S:
                self._asked_at_s = now_s
                out += self._say(messages.Ask(), now_s)
        elif self.described:
            out += self._send_requests(now_s)
        if now_s - self._spoke_at_s >= KEEP_ALIVE_S:
            out += self._say(messages.KeepAlive(), now_s)
        return out

    def close(self, now_s: float) -> bytes:
        """The last message before the connection is closed on purpose."""
        return self._say(messages.Stop(), now_s)

    def receive(self, data: bytes) -> None:
        """Take what arrived; raises `VersionError` when the program is of another version."""
        for content in self._reader.feed(data):
            message = messages.decode(content)
            if message is None:
                self.unknown += 1
                continue
            self._take(message)
            self.on_message(message)

    def _say(self, message: messages.Message, now_s: float) -> bytes:
        self._spoke_at_s = now_s
        return frame(messages.encode(message))

    def _send_requests(self, now_s: float) -> bytes:
        indices = {p.name: p.index for p in self.parameters.values()}
        out = b""
        for name, request in list(self._requests.items()):
            if name not in indices:
                del self._requests[name]
                raise UsageError(f"the program has no parameter '{name}'")
            if request.sent_at_s is None or now_s - request.sent_at_s >= _RETRY_S:
                request.sent_at_s = now_s
                out += self._say(messages.SetParameter(indices[name], request.value), now_s)
        return out

    def _take(self, message: messages.Message) -> None:
        match message:
            case messages.Hello(time_us=time_us) if time_us < _LATEST_US:
                self._introduce(message)
            case messages.Refused(version):
                self._differ(version)
            case messages.SignalDescription() if self.run is not None:
                self._signals_known.add((message.group, message.position))
                self.run.describe(message)
            case messages.ParameterDescription():
                self.parameters[message.index] = message
                self.values[message.index] = message.value
            case messages.Sample() if self.run is not None:
                self.run.add(message)
            case messages.Answer():
                self._answered(message)
            case messages.Status():
                self.status = message
            case _:
                self.unknown += 1

    def _differ(self, version: int) -> None:
        newer = "Ravenbrick" if version > messages.VERSION else "the program on the brick"
        raise VersionError(
            f"the program speaks version {version} of the telemetry protocol, this Ravenbrick "
            f"version {messages.VERSION}; bring {newer} up to date"
        )

    def _introduce(self, hello: messages.Hello) -> None:
        if hello.version != messages.VERSION:
            self._differ(hello.version)
        run = self.run
        if run is None or run.name != hello.name or hello.time_us < run.last_us:
            self.runs.append(RunLog(hello.name, hello.time_us))
            self.parameters.clear()
            self.values.clear()
        else:
            run.last_us = hello.time_us
        self._signals_known.clear()
        self._hello = hello

    def _answered(self, answer: messages.Answer) -> None:
        self.answers.append(answer)
        parameter = self.parameters.get(answer.index)
        if answer.verdict is not messages.Verdict.UNKNOWN and parameter is not None:
            self.values[answer.index] = answer.value
            self._requests.pop(parameter.name, None)
