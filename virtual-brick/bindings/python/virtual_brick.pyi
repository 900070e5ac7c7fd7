# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate virtual LEGO MINDSTORMS NXT brick.

Time is an integer number of cycles of the master clock; `clock_hz` is its frequency as an exact
fraction. A run is a function of the configuration, the image and the inputs: `trace_digest` is the
same on every machine, and how a run is cut into calls of `run_until` makes no difference.
"""

from collections.abc import Callable, Sequence
from typing import Literal, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "JIT",
    "SETTLING_BAND",
    "SOURCES",
    "SPEED_WINDOW",
    "AddressError",
    "ConfigurationError",
    "ImageError",
    "InputError",
    "Measured",
    "RecordedRun",
    "Snapshot",
    "Stop",
    "Thread",
    "VirtualBrick",
    "__version__",
]

# The project's version that the module was built for.
__version__: str
# Digest of the Rust sources that it was built from (`ravenbrick.sources.brick_digest`); empty
# when the build did not state it.
SOURCES: str
# Hot blocks become JIT code: built with `make native`.
JIT: bool
# Length (s) of the line whose slope is a speed, and the share of the final value within which a
# response has settled.
SPEED_WINDOW: float
SETTLING_BAND: float

AirKind = Literal["in_range", "out_of_range", "page", "accept", "refuse", "data", "close"]
UsbKind = Literal["reset", "control", "out", "in"]
UsbFailure = Literal["stalled", "timed_out", "no_answer"]
ScalarKind = Literal["i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64"]

class ConfigurationError(ValueError):
    """The configuration was refused; the text names the field by its path."""

class ImageError(ValueError):
    """The image was refused, or has no such symbol or scalar."""

class InputError(ValueError):
    """The input is unknown, its instant has passed or its value is not allowed."""

class AddressError(ValueError):
    """Some of the bytes asked for are not memory."""

@final
class Stop:
    """Why a run ended."""

    @property
    def reason(self) -> Literal["reached", "power_off", "fault", "halted", "trace_full"]:
        """`reached`: the run can go on. All others end the run."""
    @property
    def at_cycles(self) -> int:
        """When."""
    @property
    def message(self) -> str:
        """What happened, in a sentence; empty when reached."""

@final
class Thread:
    """A thread of the program, as its control block describes it now."""

    @property
    def name(self) -> str: ...
    @property
    def base_priority(self) -> int: ...
    @property
    def stack_base(self) -> int:
        """Lowest address."""
    @property
    def stack_size(self) -> int:
        """Bytes."""
    @property
    def stack_used(self) -> int:
        """Bytes from the lowest one that is not zero to the top."""
    @property
    def address(self) -> int:
        """Address of the control block."""
    @property
    def state(self) -> int:
        """0 unstarted, 1 ready, 2 delayed, 3 suspended, 4 blocked on an entry, 5 terminated."""

@final
class Snapshot:
    """The whole state of a brick at an instant, its trace included; kept in memory."""

@final
class VirtualBrick:
    """A brick with a program, its surroundings and the record of its run.

    While `run_until` runs, another Python thread that uses the same brick gets a RuntimeError.
    """

    def __new__(cls, configuration_json: str, elf: bytes) -> VirtualBrick:
        """Assemble a brick and load a program. Raises ConfigurationError, ImageError."""
    @staticmethod
    def from_binary(configuration_json: str, content: bytes, address: int) -> VirtualBrick:
        """As the constructor, of a program without headers: its bytes from an address on."""
    @property
    def cycles(self) -> int:
        """The present."""
    @property
    def clock_hz(self) -> tuple[int, int]:
        """Frequency of the master clock in Hz: numerator and denominator."""
    @property
    def program_counter(self) -> int:
        """Address of the next instruction."""
    @property
    def threads_unobserved(self) -> str | None:
        """Why the program's threads cannot be observed; None when they are."""
    def schedule_input(self, at_cycles: int, name: str, value: float) -> None:
        """Let an input change at an instant; of one instant, in the order of the calls.

        Raises InputError.
        """
    def enter_boot_monitor(self) -> None:
        """Bring the brick into its boot monitor (SAM-BA), as recovery does.

        The first 32 KiB of the flash and RAM are lost; a run that had ended goes on.
        """
    @property
    def in_boot_monitor(self) -> bool:
        """The monitor waits for commands on the USB, or a routine that it called runs."""
    def bluetooth_device(self) -> tuple[str, str, bool]:
        """The Bluetooth module as others see it: address, name, whether inquiries find it."""
    @property
    def bluetooth_waiting(self) -> int:
        """Bytes from the air that the program has not read yet."""
    def bluetooth_send(
        self,
        at_cycles: int,
        peer: str,
        kind: AirKind,
        data: bytes = b"",
        name: str = "",
        pin: str | None = None,
    ) -> None:
        """Let a signal of the Bluetooth device `peer` reach the brick. Raises InputError.

        `in_range` and `page` (a wish to connect) tell the device's `name`; a page needs `pin`
        unless the brick knows the device; `data` carries bytes of the stream.
        """
    def bluetooth_sent(self) -> list[tuple[int, str, AirKind, bytes, str, str | None]]:
        """What the brick sent through the air since the last call.

        Each with its cycle, the receiver, kind, data, name and PIN code.
        """
    @property
    def usb_attached(self) -> bool:
        """The cable (input `usb.plugged`) is in and the program has switched its pull-up on."""
    def usb_transfer(
        self,
        at_cycles: int,
        number: int,
        timeout_cycles: int,
        kind: UsbKind,
        endpoint: int = 0,
        data: bytes = b"",
        length: int = 0,
    ) -> None:
        """Let the USB host begin a transfer. Raises InputError.

        `data` of a `control` transfer is its request of 8 bytes and what the device gets with it;
        `length` is the most that `in` takes, up to a packet that is not full.
        """
    def usb_completed(self) -> list[tuple[int, int, bytes | None, UsbFailure | None]]:
        """Transfers that ended since the last call: cycle, number, bytes or failure."""
    def rs485_send(self, at_cycles: int, data: bytes, bit_cycles: int = 52) -> None:
        """Let bytes of another device reach the brick on the RS485 line of port 4.

        The first one begins at `at_cycles`, or after those sent before. What comes while the brick
        drives the line is lost. Raises InputError.
        """
    def rs485_sent(self) -> list[tuple[int, int]]:
        """Bytes that the brick sent on the RS485 line since the last call, each with its end."""
    def log_pins(self, pins: Sequence[int]) -> None:
        """Log the levels of these pins (0 to 31) from now on; the run is the same."""
    def logged_pins(self) -> list[tuple[int, int]]:
        """Cycle and levels (a bit per pin) at each change of a logged pin, from the begin."""
    def record_buses(self) -> None:
        """Record from now on what passes on the chip's buses; the run is the same."""
    def bus_log(self) -> list[tuple[int, str]]:
        """What passed on the buses since the last call, each with its cycle.

        `twi S 02a` (START and address byte, a: acknowledged, n: not), `twi 41a` (byte to the
        slave), `twi 5A` (byte from it), `twi P`; `display command A4`, `display data FF`;
        `usart1 out 03`, `usart0 in 5A`; `adc 2 401` (channel, count); `flash 1 992` (command in
        hexadecimal, page or bit).
        """
    def script_twi(self, turns: list[tuple[int, bytes, int]]) -> None:
        """Let a script answer on the two-wire bus in place of the co-processor.

        Each turn serves one START: how many bytes are acknowledged, the address included; the bytes
        given, FF after them; cycles for which the clock is held after each byte. After the last
        turn nobody acknowledges.
        """
    def script_converter(self, channel: int, counts: list[int]) -> None:
        """Give the chip's converter these counts on a channel, the last one for good.

        None of them: the board gives them again. Raises InputError.
        """
    def script_module(self, turns: list[tuple[int, int, bytes]]) -> None:
        """Let a script speak on USART1 in place of the Bluetooth module.

        Each turn: after how many bytes of the program since the turn before, how many cycles later,
        which bytes.
        """
    def run_until(self, cycles: int) -> Stop:
        """Run to the first instruction boundary at or after `cycles`, or until the run ends.

        Releases the interpreter lock; Ctrl-C interrupts the run, which can then go on.
        """
    def run_until_picture(self, instants: list[int], first: int, end: int) -> tuple[Stop, int]:
        """Run to `instants[first]`, in cycles, the next and so on, until the program has sent
        something to the display, the run ends, or the last before `end`: why, and the index of the
        instant then.

        At least one is run to. Interrupts as `run_until`; the instants before it are not told then.
        """
    @property
    def lcd_version(self) -> int:
        """Grows when the program sends to the display: while it stays, so does the picture."""
    def lcd(self) -> bytes:
        """The picture: 64 rows of 100 pixels from the top left, one byte 0 or 1 each."""
    def sound(self, from_cycles: int = 0) -> bytes:
        """Sound played so far: 16-bit signed little-endian samples of 1,000 cycles each."""
    def symbol(self, name: str) -> tuple[int, int]:
        """Address and size (0: unknown) of a symbol. Raises ImageError."""
    def nearest_code(self, address: int) -> tuple[str, int] | None:
        """The code symbol at or below `address` and the distance to it."""
    def read_memory(self, address: int, length: int) -> bytes:
        """Bytes as the program sees them, without side effects. Raises AddressError."""
    def read_float(self, name: str, kind: ScalarKind | None = None) -> float:
        """A scalar object now. `name` may reach into records: `functional_Y.correctedvoltage`.

        Without `kind` the debug information must tell the type. Raises ImageError.
        """
    def read_int(self, name: str, kind: ScalarKind | None = None) -> int:
        """As `read_float`; an object of a floating-point type gives its bits."""
    def add_probe(self, symbol: str, kind: ScalarKind | None = None) -> None:
        """Sample a scalar object into the signal `probe.<symbol>` from the next sample on.

        Raises ImageError.
        """
    def threads(self) -> list[Thread]:
        """The threads; a thread's position is the subject of its events."""
    def raised_at(self) -> tuple[str, int, int] | None:
        """Source file, line and column where the program failed; None where nothing tells."""
    def trace_calls(self, functions: list[str]) -> None:
        """Note the calls of these functions from now on, by their symbols; the run is the same."""
    def traced_calls(
        self,
    ) -> list[tuple[str, int, list[str], list[int], tuple[int, int]]]:
        """Of each function, first argument and place: callers (symbols, innermost first), their
        addresses, and the cycles of the first and the last call.
        """
    def call_place(self, addresses: list[int]) -> str | None:
        """Source line, `tasks.adb:57`, of the innermost of these calls that the user wrote."""
    def count_flow(self, points_json: str) -> None:
        """Count flow facts from now on, before the run begins; the run is the same.

        A JSON list of `FlowPoint` in the crate `image`, as `Response.counted` of the crate
        `wcet` has them. Raises ValueError for another form.
        """
    def flow_counts(self) -> str:
        """The counts so far in the order of the points: a JSON list of `FlowCount`."""
    def flow_arrivals(self) -> list[bytes]:
        """The arrivals so far in the order of the points: u64 cycle and count, u32 position of the
        thread (0xFFFFFFFF: none) and next instruction, little endian.
        """
    def profile(self, windows: list[tuple[int, int, int]]) -> None:
        """Note from now on the instructions of threads (by position) from a cycle to another.

        Interrupts are left out; the run is the same.
        """
    def profiled(self) -> list[bytes]:
        """The instructions of each window so far: u32 address, cycles with what transfers took,
        and these transfers if they are logged, little endian.
        """
    def log_transfers(self) -> None:
        """Log transfers of the peripheral data controller from now on; the run is the same."""
    def logged_transfers(self) -> dict[str, bytes]:
        """Cycles of the logged transfers by peripheral: little-endian, 8 bytes each."""
    @property
    def link_up_cycles(self) -> int | None:
        """When the program first asked the co-processor for its readings."""
    def stack_overflows(self) -> list[str]:
        """A sentence for each stack that overflowed: who, by how many bytes, where, what to do."""
    def thread_names(self) -> list[str]:
        """Names of the threads by the subject of events."""
    def input_names(self) -> list[str]:
        """Names of the inputs by the subject of events."""
    def events(self) -> bytes:
        """Packed events: u64 at_cycles, u32 kind, u32 subject, i64 value, little endian."""
    def take_events(self) -> bytes:
        """As `events`; they and all samples are then forgotten, for runs too long to keep whole."""
    @staticmethod
    def event_kinds() -> dict[int, str]:
        """Names of the kinds of events."""
    def signals(self) -> dict[str, tuple[bytes, bytes]]:
        """By name: sampling instants (u64 cycles) and samples (f64, SI), little endian."""
    def quantities(self) -> list[tuple[str, float]]:
        """Name and value of every physical quantity that is sampled as a signal, at the present."""
    def trace_digest(self) -> str:
        """SHA-256 of everything recorded, 64 hexadecimal digits."""
    def serve_debugger(
        self,
        port: int = 0,
        address: str = "127.0.0.1",
        *,
        on_listening: Callable[[int], object] | None = None,
        should_stop: Callable[[], bool] | None = None,
        once: bool = False,
    ) -> None:
        """Serve GDB's remote protocol over TCP until GDB ends the program.

        Port 0 takes a free one; `on_listening` is told which. `should_stop` is asked about 20 times
        a second. With `once`, the end of the first session ends the service. The brick is
        afterwards as the last session left it. Whoever can connect can control the brick: listen
        on another address than the loopback only in a network that you trust. Releases the
        interpreter lock; Ctrl-C ends the service. Raises OSError, ValueError.
        """
    def snapshot(self) -> Snapshot:
        """The whole state now."""
    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot; the run goes on from there as it did then."""

def bound_execution_times(
    elf: bytes, request: str, timing: str = "nominal", wait_states: int = 1
) -> str:
    """Bounds of execution times and stacks; question and answer are JSON.

    The keys are those of `Request` and `Response` in the crate `wcet`, module `query`. Releases
    the interpreter lock. Raises ValueError for a wrong image, annotation or request; a function
    without a bound is an answer with its `error`.
    """

def timing_parameters() -> str:
    """The parameters of `timing` in the configuration, as a JSON list.

    Each has its name, meaning, source, allowed values and the values of the three profiles.
    """

@final
class RecordedRun:
    """What a recording holds, ready to be measured; immutable."""

    def __init__(
        self,
        clock_hz: tuple[int, int],
        stop: tuple[str, int, str],
        events: bytes,
        signals: list[tuple[str, NDArray[np.uint64], NDArray[np.float64]]],
        threads: list[tuple[str, int]],
        screens: list[tuple[int, list[str]]],
        inputs: list[tuple[int, str, float]],
    ) -> None:
        """Stop: reason, cycle, message. Events as of `VirtualBrick.events`. Signals: name, arrays
        of cycles (u64) and values (f64). Threads: name, base priority. Screens: cycle, lines.
        Inputs: cycle, name, value.
        """
    def measure(self, plan_json: str) -> Measured:
        """Measure by a plan, the JSON of `Plan` in the crate `measures`.

        Releases the interpreter lock. Raises ValueError for another form, or where a signal that
        the plan needs was not recorded.
        """
    def jobs(self) -> list[list[tuple[int, int | None, int | None]]]:
        """By thread: cycles of release, start and completion of each job."""
    def stretches(self) -> list[bytes]:
        """Begins, ends, owners and interrupt sources of the run cut at its events: i64 each.

        An owner is a thread, -1 idle, -2 the run-time or -3 a handler.
        """

@final
class Measured:
    """The measures of a run; immutable."""

    def answer(self, plan_json: str) -> str:
        """The measures, and a verdict on each of the plan's criteria and sentences, as JSON.

        `virtual-brick/README.md` has the keys. Raises ValueError for what is no plan.
        """
    def value(self, measure: str) -> float | None:
        """A measure by its name in criteria; None when the run did not reach it."""
    def step(self, motor: str) -> list[bytes] | None:
        """Columns (f64) of a motor's step: s after it, fitted and true speed (rad/s); then s and
        rad/s of the plain difference of counts. None where there was no step.
        """

def expectation(sentence: str) -> str:
    """What a sentence expects, as a JSON object; raises ValueError where it is none.

    Keys: `text`, `last_named` (s), `pin`, `judges_faults`, `judges_tasks`, `task`.
    """

def fitted_speed(
    times: NDArray[np.float64],
    counts: NDArray[np.float64],
    radians_per_count: float,
    window: float,
) -> bytes:
    """Angular velocity (f64, rad/s) at `times` (f64, s, evenly spaced) from counts (f64).

    It is the slope of a line through the encoder's edges, of `window` s. Raises ValueError.
    """

def signal_unit(name: str) -> str:
    """Unit of a signal or input; empty for a ratio, a switch or a variable of the program."""
