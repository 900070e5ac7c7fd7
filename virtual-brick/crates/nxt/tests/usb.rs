// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What a USB host puts on the bus apart from transactions.
use at91sam7s::board::{Cycles, UsbSignal};
use nxt::{UsbCompletion, UsbError, UsbHost, UsbRequest, UsbTransfer};

const MS: Cycles = 48_055;

/// The cable is in and the pull-up on since cycle 0.
fn attached() -> UsbHost {
    let mut host = UsbHost::default();
    host.set_plugged(0, true);
    host.set_pull_up(0, true);
    host
}

fn signals(host: &mut UsbHost, until: Cycles) -> Vec<(Cycles, UsbSignal)> {
    let mut seen = Vec::new();
    loop {
        let now = host.next_event().min(host.next_signal());
        if now > until {
            return seen;
        }
        host.advance(now);
        while let Some(signal) = host.signal(now) {
            seen.push((now, signal));
        }
    }
}

fn reset(at_cycles: Cycles) -> UsbTransfer {
    UsbTransfer {
        at_cycles,
        id: 1,
        timeout_cycles: 100 * MS,
        request: UsbRequest::Reset,
    }
}

#[test]
fn the_bus_of_a_new_device_is_idle_until_a_reset_of_10_ms() {
    let mut host = attached();
    assert!(host.schedule(reset(50 * MS)));
    let seen = signals(&mut host, 61 * MS);
    let (at, kinds): (Vec<Cycles>, Vec<UsbSignal>) = seen.iter().copied().unzip();
    assert_eq!(
        kinds,
        [
            UsbSignal::Suspend,
            UsbSignal::ResetBegins,
            UsbSignal::Reset,
            UsbSignal::StartOfFrame { number: 1 },
        ]
    );
    let [idle, begin, end, frame] = at[..] else {
        panic!("{seen:?}");
    };
    let near = |at: Cycles, expected: Cycles| at.abs_diff(expected) < MS / 10;
    assert!(near(idle, 3 * MS) && near(begin, 50 * MS), "{seen:?}");
    assert!(
        near(end - begin, 10 * MS) && near(frame - end, MS),
        "{seen:?}"
    );
    let done = UsbCompletion {
        at_cycles: end,
        id: 1,
        result: Ok(Vec::new()),
    };
    assert_eq!(host.take_completed(), [done]);
}

#[test]
fn a_reset_ends_with_the_cable() {
    let mut host = attached();
    assert!(host.schedule(reset(0)));
    signals(&mut host, 5 * MS);
    host.set_plugged(5 * MS, false);
    let [UsbCompletion { result, .. }] = &host.take_completed()[..] else {
        panic!("one transfer");
    };
    assert_eq!(*result, Err(UsbError::NoAnswer));
    assert!(signals(&mut host, 50 * MS)
        .iter()
        .all(|(_, signal)| *signal == UsbSignal::Suspend));
}
