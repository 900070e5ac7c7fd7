# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the vehicle does when its joystick and buttons are used."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick, battery

START_MS = 600
STOPPED, CLOSED_LOOP, OPEN_LOOP, STEP_RESPONSE, OFF = range(5)
RESERVE, CRUISE_SHARE = 2.0, 0.8
Start = Callable[..., Brick]


def touch(device: Brick, at_ms: float) -> None:
    """Press the touch sensor for 100 ms."""
    device.set(at_ms, "touch.1", 1)
    device.set(at_ms + 100, "touch.1", 0)


def values(device: Brick, what: str) -> tuple[float, float]:
    """Left and right value of a quantity, in volts."""
    return device.number(f"vehicle_{what}_left"), device.number(f"vehicle_{what}_right")


def test_it_stands_until_the_touch_sensor_is_pressed(vehicle: Start) -> None:
    """Without a touch no motor gets a voltage."""
    device = vehicle()
    device.run(1_500)
    assert device.integer("vehicle_mode") == STOPPED
    assert all(command.duty == 0 for command in device.motor_commands())


def test_a_touch_starts_it_and_the_next_one_stops_it(vehicle: Start) -> None:
    """Holding the sensor is one touch; a stop brakes both wheels."""
    device = vehicle()
    touch(device, START_MS)
    touch(device, 1_600)
    device.run(1_590)
    assert device.integer("vehicle_mode") == CLOSED_LOOP
    assert all(device.motors(1_590)[motor][0] > 0 for motor in "BC")
    device.run(1_700)
    assert device.integer("vehicle_mode") == STOPPED
    assert device.motors(1_700)["B"] == device.motors(1_700)["C"] == (0, True)
    assert values(device, "setpoint") == (0.0, 0.0)


@pytest.mark.parametrize("volts", [7.2, 8.0, 9.0])
def test_the_battery_sets_the_speed(vehicle: Start, volts: float) -> None:
    """Set-points and the controller's limit follow the battery, and the wheels the set-points."""
    device = vehicle(battery=battery(volts))
    touch(device, START_MS)
    device.run(START_MS + 1_000)
    wanted = CRUISE_SHARE * (volts - RESERVE)
    assert values(device, "setpoint") == pytest.approx((wanted, wanted), abs=0.03)
    assert values(device, "speed") == pytest.approx((wanted, wanted), abs=0.3)
    assert device.device.read_float("functional_P.Saturation") == pytest.approx(volts, abs=0.03)


@pytest.mark.parametrize(
    ("angle", "inner", "outer"), [(0.5, "left", "right"), (-0.5, "right", "left")]
)
def test_the_joystick_slows_the_inner_wheel(
    vehicle: Start, angle: float, inner: str, outer: str
) -> None:
    """Positive angles steer to the left, negative ones to the right."""
    device = vehicle()
    touch(device, START_MS)
    device.set(START_MS + 500, "motor.A.hand_angle", angle)
    device.run(START_MS + 1_500)
    cruise = device.number(f"vehicle_setpoint_{outer}")
    degrees = abs(device.integer("vehicle_joystick"))
    assert degrees == pytest.approx(28.6, abs=1.0)
    slowed = cruise * (90 - degrees) / 90
    assert device.number(f"vehicle_setpoint_{inner}") == pytest.approx(slowed, abs=0.01)
    assert device.number(f"vehicle_speed_{inner}") == pytest.approx(slowed, abs=0.3)


def test_the_left_button_selects_the_open_loop(vehicle: Start) -> None:
    """Held at the start, it sends the set-points to the motors as they are."""
    device = vehicle()
    device.set(START_MS - 100, "button.left", 1)
    touch(device, START_MS)
    device.set(START_MS + 200, "button.left", 0)
    device.run(START_MS + 1_000)
    assert device.integer("vehicle_mode") == OPEN_LOOP
    assert values(device, "control") == values(device, "setpoint")
    duty = device.motors(START_MS + 1_000)["B"][0]
    assert duty == round(100 * device.number("vehicle_setpoint_left") / 8.0)


def test_the_right_button_selects_the_step_response(vehicle: Start) -> None:
    """Held at the start, it makes both set-points 4 V, whatever the joystick says."""
    device = vehicle()
    device.set(START_MS - 300, "motor.A.hand_angle", 0.5)
    device.set(START_MS - 100, "button.right", 1)
    touch(device, START_MS)
    device.run(START_MS + 1_000)
    assert device.integer("vehicle_mode") == STEP_RESPONSE
    assert values(device, "setpoint") == (4.0, 4.0)
    assert values(device, "speed") == pytest.approx((4.0, 4.0), abs=0.3)


def test_the_orange_button_stops_it_and_switches_off(vehicle: Start) -> None:
    """From full drive to no supply within 50 ms, motors first."""
    device = vehicle()
    touch(device, START_MS)
    device.set(1_500, "button.orange", 1)
    stop = device.run_to_end(1_550)
    assert stop.reason == "power_off"
    assert device.integer("vehicle_mode") == OFF
    assert all(device.motors(1_550)[motor][0] == 0 for motor in "ABC")


def test_the_display_shows_the_state(vehicle: Start) -> None:
    """Mode, set-points, speeds, outputs, joystick, battery and link errors, every 500 ms."""
    device = vehicle()
    touch(device, START_MS)
    device.run(2_200)
    title, names, setpoint, speed, _, joystick, millivolts, errors = device.text()
    assert (title, names) == ("closed loop", "volts left right")
    assert setpoint == "set  4.79  4.79"
    assert [float(text) for text in speed.split()[1:]] == pytest.approx([4.8, 4.8], abs=0.3)
    assert (joystick, errors) == ("joystick deg   0", "link errors    0")
    assert float(millivolts.split()[-1]) == pytest.approx(8_000, abs=28)


def test_no_stack_is_more_than_half_full(vehicle: Start) -> None:
    """After a drive with turns every task has used less than half of its stack."""
    device = vehicle()
    touch(device, START_MS)
    device.set(1_500, "motor.A.hand_angle", 1.0)
    device.run(3_000)
    threads = device.device.threads()
    assert len(threads) == 4
    for thread in threads:
        assert thread.stack_used < thread.stack_size / 2, thread.name
