// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Behaviour of a trace seen from outside.
#![allow(clippy::unwrap_used)]

use trace::{Event, EventKind, Limits, NameSpace, Trace, TraceError, PACKED_EVENT_LENGTH};

fn event(at_cycles: u64) -> Event {
    Event {
        at_cycles,
        kind: EventKind::Release,
        subject: 3,
        value: -4,
    }
}

fn sample_trace() -> Trace {
    let mut trace = Trace::new(Limits::default());
    trace.names_mut().intern(NameSpace::Thread, "control");
    trace.record(event(10)).unwrap();
    trace.declare_signal("motor.B.angle");
    trace.sample(20, &[0.5]).unwrap();
    trace
}

fn traces_that_differ_in_one_field() -> Vec<Trace> {
    let base = event(10);
    let events = [
        Event {
            at_cycles: 11,
            ..base
        },
        Event {
            kind: EventKind::Completion,
            ..base
        },
        Event { subject: 4, ..base },
        Event { value: -5, ..base },
    ];
    let mut traces: Vec<Trace> = events
        .into_iter()
        .map(|event| {
            build(
                "control",
                NameSpace::Thread,
                event,
                "motor.B.angle",
                20,
                0.5,
            )
        })
        .collect();
    traces.extend(
        [
            ("display", NameSpace::Thread, "motor.B.angle", 20, 0.5),
            ("control", NameSpace::Motor, "motor.B.angle", 20, 0.5),
            ("control", NameSpace::Thread, "motor.C.angle", 20, 0.5),
            ("control", NameSpace::Thread, "motor.B.angle", 21, 0.5),
            ("control", NameSpace::Thread, "motor.B.angle", 20, 0.25),
        ]
        .map(|(name, space, signal, at_cycles, value)| {
            build(name, space, base, signal, at_cycles, value)
        }),
    );
    traces
}

fn build(
    name: &str,
    space: NameSpace,
    event: Event,
    signal: &str,
    at_cycles: u64,
    value: f64,
) -> Trace {
    let mut trace = Trace::new(Limits::default());
    trace.names_mut().intern(space, name);
    trace.record(event).unwrap();
    trace.declare_signal(signal);
    trace.sample(at_cycles, &[value]).unwrap();
    trace
}

#[test]
fn equal_records_have_equal_digests() {
    assert_eq!(sample_trace().digest(), sample_trace().digest());
    assert_eq!(sample_trace().digest().to_string().len(), 64);
}

#[test]
fn the_digest_depends_on_every_field() {
    let mut digests: Vec<String> = traces_that_differ_in_one_field()
        .iter()
        .map(|t| t.digest().to_string())
        .collect();
    digests.push(sample_trace().digest().to_string());
    let count = digests.len();
    digests.sort();
    digests.dedup();
    assert_eq!(digests.len(), count);
}

#[test]
fn the_digest_of_an_empty_trace_is_the_hash_of_its_written_encoding() {
    // sha256 of "ravenbrick trace 1\n" followed by 40 zero bytes, from an independent tool.
    let expected = "b9ad67f2248893aceb23d4a3cb73d1c62baed2597228f1774f52a524900a8aec";
    assert_eq!(Trace::new(Limits::default()).digest().to_string(), expected);
}

#[test]
fn the_digest_depends_on_the_order_of_simultaneous_events() {
    let first = Event {
        subject: 1,
        ..event(10)
    };
    let second = Event {
        subject: 2,
        ..event(10)
    };
    let digest = |events: [Event; 2]| {
        let mut trace = Trace::new(Limits::default());
        events
            .into_iter()
            .for_each(|event| trace.record(event).unwrap());
        trace.digest()
    };
    assert_ne!(digest([first, second]), digest([second, first]));
}

#[test]
fn every_nan_has_the_same_digest() {
    let digest = |bits: u64| {
        let mut trace = Trace::new(Limits::default());
        trace.declare_signal("x");
        trace.sample(0, &[f64::from_bits(bits)]).unwrap();
        trace.digest()
    };
    assert_eq!(digest(0x7FF8_0000_0000_0000), digest(0xFFF8_0000_0000_0001));
}

#[test]
fn an_event_before_the_last_one_is_refused() {
    let mut trace = sample_trace();
    let error = trace.record(event(9)).unwrap_err();
    assert_eq!(
        error,
        TraceError::OutOfOrder {
            previous_cycles: 10,
            at_cycles: 9
        }
    );
    assert_eq!(trace.events().len(), 1);
}

#[test]
fn the_limit_on_events_is_an_error_that_names_it() {
    let mut trace = Trace::new(Limits {
        events: 2,
        signal_values: 0,
    });
    trace.record(event(1)).unwrap();
    trace.record(event(2)).unwrap();
    let error = trace.record(event(3)).unwrap_err();
    assert_eq!(error, TraceError::TooManyEvents { limit: 2 });
    assert!(error.to_string().contains("trace_limits.events"));
}

#[test]
fn the_limit_on_signal_values_counts_all_signals() {
    let mut trace = Trace::new(Limits {
        events: 0,
        signal_values: 3,
    });
    trace.declare_signal("a");
    trace.declare_signal("b");
    trace.sample(1, &[1.0, 2.0]).unwrap();
    let error = trace.sample(2, &[1.0, 2.0]).unwrap_err();
    assert_eq!(error, TraceError::TooManySignalValues { limit: 3 });
}

#[test]
fn a_row_must_have_one_value_per_signal() {
    let mut trace = sample_trace();
    let error = trace.sample(30, &[1.0, 2.0]).unwrap_err();
    assert_eq!(
        error,
        TraceError::WrongSampleLength {
            expected: 1,
            given: 2
        }
    );
}

#[test]
fn a_signal_declared_later_starts_with_the_next_row() {
    let mut trace = sample_trace();
    assert_eq!(trace.declare_signal("probe.x"), 1);
    trace.sample(30, &[0.75, 7.0]).unwrap();
    let late = trace.signals().get("probe.x").unwrap();
    assert_eq!((late.at_cycles, late.values), (&[30][..], &[7.0][..]));
    let early = trace.signals().get("motor.B.angle").unwrap();
    assert_eq!(
        (early.at_cycles, early.values),
        (&[20, 30][..], &[0.5, 0.75][..])
    );
}

#[test]
fn names_keep_the_index_of_their_first_use() {
    let mut trace = sample_trace();
    let names = trace.names_mut();
    assert_eq!(names.intern(NameSpace::Thread, "display"), 1);
    assert_eq!(names.intern(NameSpace::Thread, "control"), 0);
    assert_eq!(names.add(NameSpace::Thread, "control"), 2);
    names.rename(NameSpace::Thread, 2, "control (2)");
    assert_eq!(
        names.all(NameSpace::Thread),
        ["control", "display", "control (2)"]
    );
}

#[test]
fn packed_events_are_little_endian_records() {
    let trace = sample_trace();
    let packed = trace.events().packed();
    assert_eq!(packed.len(), PACKED_EVENT_LENGTH);
    assert_eq!(packed[0..8], 10u64.to_le_bytes());
    assert_eq!(packed[8..12], 3u32.to_le_bytes());
    assert_eq!(packed[12..16], 3u32.to_le_bytes());
    assert_eq!(packed[16..24], (-4i64).to_le_bytes());
}

#[test]
fn every_event_kind_has_its_own_number_and_name() {
    let mut names: Vec<&str> = EventKind::ALL.iter().map(|kind| kind.name()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), EventKind::ALL.len());
    for (index, kind) in EventKind::ALL.into_iter().enumerate() {
        assert_eq!(kind.number() as usize, index + 1);
    }
}

#[test]
fn a_signal_declared_late_goes_on_when_all_samples_are_forgotten() {
    let mut trace = sample_trace();
    trace.declare_signal("late");
    trace.sample(40, &[0.25, 0.5]).unwrap();
    assert!(!trace.take_events().is_empty());
    assert!(!trace.digest().to_string().is_empty());
    trace.sample(50, &[0.75, 1.0]).unwrap();
    let late = trace.signals().get("late").unwrap();
    assert_eq!((late.at_cycles, late.values), (&[50][..], &[1.0][..]));
}

#[test]
fn a_trace_cut_back_to_a_mark_is_the_trace_of_that_time() {
    let mut trace = sample_trace();
    let (mark, digest) = (trace.mark(), trace.digest());
    trace.record(event(40)).unwrap();
    trace.sample(40, &[0.25]).unwrap();
    trace.declare_signal("late");
    trace.names_mut().rename(NameSpace::Thread, 0, "other");
    let longer = trace.mark();
    assert_ne!(trace.digest(), digest);
    assert!(trace.truncate(&mark));
    assert_eq!(trace.digest(), digest);
    assert!(!trace.truncate(&longer));
    assert_eq!(trace.digest(), digest);
    trace.sample(30, &[0.25]).unwrap();
}

#[test]
fn kinds_have_the_names_and_numbers_that_host_and_page_read() {
    let catalogue = include_str!("../../../../catalogue/trace.json");
    let lines: Vec<_> = EventKind::ALL
        .iter()
        .map(|kind| format!("  \"{}\": {}", kind.name(), kind.number()))
        .collect();
    let events = format!("\"events\": {{\n{}\n }}", lines.join(",\n"));
    assert!(
        catalogue.contains(&events),
        "not in catalogue/trace.json:\n{events}"
    );
}
