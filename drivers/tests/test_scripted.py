# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Drivers against scripted peripherals: a scenario goes in, the exact log of the bus comes out."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import pytest

from verification.support.bricks.observe import HEIGHT, WIDTH, Brick
from verification.support.bricks.power_cut import FIRST_PAGE

GREETING = b"\xccLet's samba nxt arm in arm, (c)LEGO System A/S"
WILLING = (99, b"", 0)
NOBODY = (0, b"", 0)
SENSOR_2 = 1
ROWS = 8


def lines(device: Brick, bus: str, begin: Iterable[str]) -> list[str]:
    """The log of a bus in words; a new line where one of these words begins."""
    found: list[str] = []
    for _, event in device.device.bus_log():
        name, _, words = event.partition(" ")
        if name != bus:
            continue
        if not found or words.startswith(tuple(begin)):
            found.append(words)
        else:
            found[-1] += " " + words
    return found


def transfers(device: Brick) -> list[str]:
    """Transfers on the two-wire bus."""
    return lines(device, "twi", ["S"])


def readings(sensor_2: int, spoil: int = 0) -> bytes:
    """The co-processor's frame with a reading of port 2."""
    words = [1023] * 4 + [0, 0x2400 + 500]
    words[SENSOR_2] = sensor_2
    data = b"".join(word.to_bytes(2, "little") for word in words)
    return data + bytes([(0xFF - sum(data)) % 256 ^ spoil])


def received(frame: bytes) -> str:
    """The log of a frame that is read."""
    return "S 03a " + " ".join(f"{byte:02X}" for byte in frame) + " P"


IDLE = "S 02a 00a 08a 00a 00a 00a 00a 07a 00a F0a P"
GREETED = "S 02a " + " ".join(f"{byte:02X}a" for byte in GREETING) + " P"
START_MS, EXCHANGE_MS = 45.0, 4.0


@pytest.fixture
def link(brick: Callable[..., Brick]) -> Callable[..., Brick]:
    """From the turns after the greeting to a brick that records its bus."""

    def start(*turns: tuple[int, bytes, int]) -> Brick:
        device = brick("link")
        device.device.record_buses()
        device.device.script_twi([WILLING, *turns])
        return device

    return start


def test_the_link_greets_then_exchanges(link: Callable[..., Brick]) -> None:
    """The text, then a frame of readings and one of commands in turn, each 2 ms."""
    frames = [readings(300), readings(400)]
    device = link((1, frames[0], 0), WILLING, (1, frames[1], 0), WILLING)
    device.run(START_MS + 2 * EXCHANGE_MS)
    assert transfers(device) == [GREETED, received(frames[0]), IDLE, received(frames[1]), IDLE]


def test_a_slave_that_stretches_the_clock_is_waited_for(link: Callable[..., Brick]) -> None:
    """50 us after each byte: the same log, and no error."""
    stretch = 2_400
    device = link((1, readings(300), stretch), (99, b"", stretch), (1, readings(1), 0), WILLING)
    device.run(START_MS + 2 * EXCHANGE_MS)
    assert transfers(device) == [
        GREETED,
        received(readings(300)),
        IDLE,
        received(readings(1)),
        IDLE,
    ]


def test_commands_that_are_refused_are_sent_again(link: Callable[..., Brick]) -> None:
    """A NACK in the address, the first and a later byte ends the transfer, and no more."""
    read = (1, readings(300), 0)
    device = link(read, NOBODY, read, (1, b"", 0), read, (4, b"", 0), read, WILLING)
    device.run(START_MS + 4 * EXCHANGE_MS)
    assert [line for line in transfers(device)[1:] if line.startswith("S 02")] == [
        "S 02n P",
        "S 02a 00n P",
        "S 02a 00a 08a 00a 00n P",
        IDLE,
    ]


def test_wrong_sums_leave_the_value_before(link: Callable[..., Brick]) -> None:
    """Two spoilt frames are counted, and the next good one counts again."""
    spoilt = readings(900, spoil=1)
    turns = [(1, frame, 0) for frame in (readings(300), spoilt, spoilt, readings(500))]
    device = link(*(turn for read in turns for turn in (read, WILLING)), *[WILLING] * 200)
    device.run(START_MS + 4 * EXCHANGE_MS)
    log = transfers(device)[1::2]
    assert log == [received(f) for f in (readings(300), spoilt, spoilt, readings(500))]
    device.run(210)
    assert device.integer("sensor") == 500


def test_a_silent_slave_is_greeted_again(link: Callable[..., Brick]) -> None:
    """Four refusals in one direction, a pause of 40 ms, the text, until somebody answers."""
    read = (1, readings(300), 0)
    device = link(read, WILLING, *[NOBODY] * 7, WILLING, WILLING, read, WILLING)
    device.run(START_MS + 6 * EXCHANGE_MS + 100)
    log = transfers(device)
    assert log[:3] == [GREETED, received(readings(300)), IDLE]
    refused = log[3 : log.index(GREETED, 1)]
    assert sorted(set(refused)) == ["S 02n P", "S 03n P"]
    assert refused.count("S 03n P") == 4
    after = log[log.index(GREETED, 1) + 1 :]
    assert after[:3] == [IDLE, received(readings(300)), IDLE]


def test_the_display_gets_exactly_this(brick: Callable[..., Brick]) -> None:
    """Reset, set-up, then pages with their addresses; the last eight are the picture."""
    device = brick("display_text")
    device.device.record_buses()
    device.run(150)
    log = lines(device, "display", ["command"])
    runs: list[tuple[str, list[int]]] = []
    for words in " ".join(log).replace("command ", "c").replace("data ", "d").split():
        if not runs or runs[-1][0] != words[0]:
            runs.append((words[0], []))
        runs[-1][1].append(int(words[1:], 16))
    set_up = [0xE2, 0x23, 0x27, 0x29, 0x2F, 0xEB, 0x81, 0x5A]
    set_up += [0xA0, 0x88, 0xC4, 0x40, 0xA4, 0xA6, 0xAF]
    pages = list(zip(runs[::2], runs[1::2], strict=True))
    assert len(pages) % ROWS == 0
    pixels = device.device.lcd()
    for number, (address, data) in enumerate(pages):
        row = number % ROWS
        expected = [0xB0 + row, 0x10, 0x00]
        assert address == ("c", expected if number else [*set_up, *expected])
        assert len(data[1]) == WIDTH
        if number >= len(pages) - ROWS:
            column = [
                sum(pixels[(8 * row + bit) * WIDTH + x] << bit for bit in range(HEIGHT // ROWS))
                for x in range(WIDTH)
            ]
            assert data == ("d", column)


RESET = bytes.fromhex("0314FFE9")
ADDRESS = bytes.fromhex("0A2800165301020300FF5F")
NAMED, FOUND = bytes.fromhex("042201FFD9"), bytes.fromhex("042001FFDB")
ASKED = [
    "out 03 27 FF D9",
    "out 13 21 41 64 61 00 00 00 00 00 00 00 00 00 00 00 00 00 FE D9",
    "out 04 1C 01 FF E3",
]
MS = 48_055


def frames(device: Brick) -> list[str]:
    """What the program sends on the line to the Bluetooth module, frame by frame."""
    sent = [event[11:] for _, event in device.device.bus_log() if event.startswith("usart1 out")]
    found = []
    while sent:
        length = 1 + int(sent[0], 16)
        found.append("out " + " ".join(sent[:length]))
        sent = sent[length:]
    return found


@pytest.fixture
def module(brick: Callable[..., Brick]) -> Callable[..., Brick]:
    """From the module's turns to a brick that speaks with them."""

    def start(*turns: tuple[int, int, bytes]) -> Brick:
        device = brick("bluetooth_script")
        device.device.record_buses()
        device.device.script_module(list(turns))
        return device

    return start


ANSWERS = [(4, MS, ADDRESS), (20, MS, NAMED), (5, MS, FOUND)]


def test_the_module_is_asked_exactly_this(module: Callable[..., Brick]) -> None:
    """Its address, then the name with its sum, then to be found."""
    device = module((0, 300 * MS, RESET), *ANSWERS)
    device.run(1_000)
    assert frames(device) == ASKED
    assert (device.integer("ready"), device.integer("ended")) == (1, 1)


def test_noise_before_the_module_starts_is_no_obstacle(module: Callable[..., Brick]) -> None:
    """A frame with a wrong sum and an unknown message are passed over."""
    wrong = bytes.fromhex("0314FFE8")
    unknown = bytes.fromhex("037EFF7F")
    device = module((0, 200 * MS, wrong + unknown), (0, 300 * MS, RESET), *ANSWERS)
    device.run(1_200)
    assert frames(device) == ASKED
    assert device.integer("ready") == 1


def test_a_spoilt_answer_is_no_answer(module: Callable[..., Brick]) -> None:
    """The wait of half a second ends, and the next question is put all the same."""
    spoilt = NAMED[:-1] + b"\x00"
    device = module((0, 300 * MS, RESET), ANSWERS[0], (20, MS, spoilt), ANSWERS[2])
    device.run(1_500)
    assert frames(device) == ASKED
    assert device.integer("ended") == 1


def test_a_silent_module_is_given_up(module: Callable[..., Brick]) -> None:
    """After five seconds, without a byte to it; the program goes on."""
    device = module()
    device.run(4_900)
    assert device.integer("ready") == -1
    device.run(7_500)
    assert device.integer("ready") == 0
    assert device.integer("ended") == 1


COUNTS = {"off": [100], "red": [400], "green": [250], "blue": [180]}


def test_the_converter_is_asked_twice_for_each_lamp(brick: Callable[..., Brick]) -> None:
    """Eight conversions in a measurement; the counts of the script are the colour's parts."""
    device = brick("color", sensors={"2": {"kind": "color"}})
    device.run(200)
    device.device.record_buses()
    script = [100, 100, 400, 402, 250, 250, 180, 181]
    device.device.script_converter(2, script * 40)
    before = device.integer("rounds")
    while device.integer("rounds") == before:
        device.device.run_until(device.device.cycles + 4_000)
    log = [event for _, event in device.device.bus_log() if event.startswith("adc")]
    assert log[: len(script)] == [f"adc 2 {count}" for count in script]
    red, green, blue, _ = device.integers("parts")
    factors = [255 / 330, 255 / 255, 255 / 280]
    differences = (401 - 100, 250 - 100, 180 - 100)
    expected = [int(f * d + 0.01) for f, d in zip(factors, differences, strict=True)]
    assert [red, green, blue] == pytest.approx(expected, abs=1)


def test_each_saving_is_one_command_to_the_flash(brick: Callable[..., Brick]) -> None:
    """Pages one after the other; the page of the value saved seldom is passed over."""
    device = brick("parameters")
    device.device.record_buses()
    device.run(400)
    log = lines(device, "flash", ["1"])
    ring = [FIRST_PAGE + place for place in range(32)]
    assert log[:32] == [f"1 {page}" for page in ring]
    assert all(line.startswith("1 ") for line in log)


def test_pages_that_fail_are_followed_by_others(brick: Callable[..., Brick]) -> None:
    """While the supply is too low for programming three pages are tried in each saving."""
    device = brick("parameters")
    device.run(100)
    device.device.record_buses()
    saved, failed = device.integer("saved_number"), device.integer("failures")
    device.set(100.1, "battery.voltage", 3.0)
    device.run(165)
    pages = [int(line[2:]) for line in lines(device, "flash", ["1"])]
    assert pages == list(range(pages[0], pages[0] + len(pages)))
    assert len(pages) >= 6
    assert device.integer("failures") >= failed + 2
    device.set(165, "battery.voltage", 8.0)
    device.run(300)
    assert device.integer("saved_number") > saved


def test_rs485_frames_pass_in_both_directions(brick: Callable[..., Brick]) -> None:
    """What the script sends and what the program answers, byte by byte."""
    device = brick("rs485_line")
    device.device.record_buses()
    device.device.rs485_send(device.cycles(150.1), b"\x03\x0f\xf0")
    device.run(160)
    assert lines(device, "usart0", ["in 03", "out FC"]) == [
        "in 03 in 0F in F0",
        "out FC out F0 out 0F",
    ]
