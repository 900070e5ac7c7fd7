// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Random requests: a program, what is recorded of it, inputs, and where it is stopped. All
//! engines answer a request alike.

use virtual_brick::{
    Access, Configuration, CpuStep, Engine, FlowPoint, ScalarKind, StepObserver, Stop, StopReason,
    Timing, VirtualBrick,
};

use super::random::{self, Kind, Numbers};
use super::vehicle;

/// Programs, and the longest piece of a run between two stops, in cycles.
pub const KINDS: [(Kind, u32); 4] = [
    (Kind::Ram, 20_000),
    (Kind::Flash, 200_000),
    (Kind::SlowFlash, 4_000_000),
    (Kind::Devices, 20_000),
];
const PIECES: u32 = 16;
const INPUTS: [&str; 7] = [
    "touch.1",
    "button.orange",
    "motor.A.hand_angle",
    "motor.B.load_torque",
    "variable.number:u32",
    "variable.patch:u32",
    "battery.voltage",
];
/// ADD r3, r3, #1, as a variable: harmless where it replaces an instruction.
const HARMLESS: f64 = 0xE283_3001_u32 as f64;

/// Ends a call after so many steps.
struct Steps(u32);

impl StepObserver for Steps {
    const SEES_ACCESSES: bool = false;

    fn before_step(&mut self, _brick: &VirtualBrick) -> bool {
        self.0 == 0
    }

    fn access(&mut self, _access: Access) {}

    fn after_step(&mut self, _brick: &VirtualBrick, _step: CpuStep) -> bool {
        self.0 -= 1;
        false
    }
}

/// Answers a random request with all engines; the stop at its end, or what differs.
///
/// # Errors
/// Two engines differ, or the program cannot be loaded.
pub fn compare(seed: u64, kind: Kind, longest: u32) -> Result<StopReason, String> {
    let numbers = &mut Numbers::new(seed ^ 0x5EED);
    let elf = random::image(seed, kind);
    let configuration = configuration(numbers);
    let brick = |engine| {
        let mut configuration = configuration.clone();
        configuration.engine = engine;
        VirtualBrick::new(&configuration, &elf).map_err(|error| error.to_string())
    };
    let mut reference = brick(Engine::Reference)?;
    let mut others = [
        ("JIT code", brick(Engine::Fast)?),
        ("blocks", brick(Engine::Blocks)?),
    ];
    let mut stop = reference.run_until(0);
    for _ in 0..PIECES {
        let until = reference.cycles() + length(numbers, longest);
        let drawn = numbers.below(u32::MAX);
        stop = piece(
            &mut reference,
            &mut Numbers::new(drawn.into()),
            (kind, until),
        );
        for (name, other) in &mut others {
            let theirs = piece(other, &mut Numbers::new(drawn.into()), (kind, until));
            let place = format!("{name}, seed {seed}, {kind:?}, to cycle {until}");
            if theirs != stop {
                return Err(format!("{place}: {theirs:?} instead of {stop:?}"));
            }
            if let Some(what) = difference(other, &reference) {
                return Err(format!("{place}: {what}"));
            }
        }
    }
    Ok(stop.reason)
}

fn length(numbers: &mut Numbers, longest: u32) -> u64 {
    let most = [3, 40, 1_000, longest, longest][numbers.below(5) as usize];
    u64::from(1 + numbers.below(most))
}

/// Early compilation, in the run or by the thread; traces that fill up; any timing.
fn configuration(numbers: &mut Numbers) -> Configuration {
    let mut configuration = vehicle();
    configuration.jit_threshold_runs = 1 + numbers.below(8);
    configuration.jit_synchronous = numbers.below(3) > 0;
    configuration.timing = [
        Timing::nominal(),
        Timing::nominal(),
        Timing::optimistic(),
        Timing::pessimistic(),
    ][numbers.below(4) as usize];
    // With another one only the reference engine runs.
    let loss = Timing::nominal().chip.code_buffer_loss;
    configuration.timing.chip.code_buffer_loss = loss;
    configuration.guards_threads = numbers.below(4) == 0;
    if numbers.below(2) == 0 {
        configuration.trace_limits.events = numbers.below(300) as usize;
    }
    if numbers.below(4) == 0 {
        configuration.trace_limits.signal_values = numbers.below(3_000) as usize;
    }
    if numbers.below(2) == 0 {
        configuration.signal_period_cycles = u64::from(10 + numbers.below(3_000));
    }
    configuration
}

/// Asks something more of the brick and runs on.
fn piece(brick: &mut VirtualBrick, numbers: &mut Numbers, (kind, until): (Kind, u64)) -> Stop {
    let now = brick.cycles();
    let code = random::base(kind) + 4 * numbers.below(400);
    match numbers.below(16) {
        0..=2 => {
            let name = INPUTS[numbers.below(INPUTS.len() as u32) as usize];
            let value = match name {
                "variable.patch:u32" => HARMLESS,
                "battery.voltage" => [9.0, 8.0, 7.0, 1.0][numbers.below(4) as usize],
                _ => f64::from(numbers.below(2)),
            };
            let at_cycles = now + u64::from(numbers.below((until - now) as u32 + 200));
            // A program without these variables does without.
            let _ = brick.schedule_input(at_cycles, name, value);
        }
        3 => drop(brick.take_events()),
        4 => {
            let copy = brick.snapshot();
            brick.run_until(until);
            brick.restore(&copy);
        }
        5 => brick.trace_calls(&["called".to_owned(), "also_called".to_owned()]),
        6 => brick.count_flow(vec![FlowPoint::Place {
            addresses: vec![code, code + 4],
        }]),
        7 => {
            let begin = now + u64::from(numbers.below(2_000));
            brick.profile([(0, begin, begin + 500).into()].into_iter());
        }
        8 => drop(brick.add_probe("number", Some(ScalarKind::U32))),
        9 => {
            brick.run_observed(until, &mut Steps(numbers.below(40)));
        }
        _ => {}
    }
    brick.run_until(until)
}

/// In what two bricks differ, the first thing found.
pub fn difference(one: &VirtualBrick, other: &VirtualBrick) -> Option<String> {
    let differs = |what: &str, same: bool| (!same).then(|| what.to_owned());
    let memory = |brick: &VirtualBrick| brick.read_memory(0x0020_0000, 0x1_0000);
    let (cycles, expected) = (one.cycles(), other.cycles());
    differs(
        &format!("{cycles} instead of {expected} cycles"),
        cycles == expected,
    )
    .or_else(|| differs("processor", one.processor() == other.processor()))
    .or_else(|| differs("memory", memory(one) == memory(other)))
    .or_else(|| differs("record", one.trace().digest() == other.trace().digest()))
    .or_else(|| differs("threads", one.threads() == other.threads()))
    .or_else(|| differs("calls", one.traced_calls() == other.traced_calls()))
    .or_else(|| differs("flow", one.flow_counts() == other.flow_counts()))
    .or_else(|| differs("profile", one.profiled() == other.profiled()))
    .or_else(|| differs("picture", one.lcd() == other.lcd()))
    .or_else(|| {
        let (stacks, expected) = (one.stack_overflows(), other.stack_overflows());
        let what = format!("{stacks:?} instead of {expected:?}");
        differs(&what, stacks == expected)
    })
}
