// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Cycles of a path and, where it is recorded, the steps that they are made of.
//!
//! Steps are kept as a list from the last one back, which paths with a common beginning share.

mod path_tree;

pub use path_tree::PathTree;

use std::fmt;
use std::rc::Rc;

/// Stands for a path without a bound.
pub const UNBOUNDED: u64 = u64::MAX;

/// Cycles on the longest path to a point. Two states that differ in nothing else are equal.
#[derive(Clone, Default)]
pub struct Elapsed {
    /// Cycles; `UNBOUNDED` where no number is known.
    pub cycles: u64,
    /// The last step; none where the path is not recorded.
    last: Option<Rc<Step>>,
}

impl PartialEq for Elapsed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Elapsed {}

impl fmt::Debug for Elapsed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cycles", self.cycles)
    }
}

struct Step {
    before: Option<Rc<Step>>,
    part: Part,
}

enum Part {
    /// The record begins.
    Begin,
    Instruction {
        address: u32,
        executions: u64,
        cycles: u64,
    },
    /// The steps after one up to another, so many times.
    Repeated {
        after: Option<Rc<Step>>,
        last: Rc<Step>,
        times: u64,
    },
    /// A call by the instruction before, and what it is charged beyond its steps.
    Call {
        callee: u32,
        last: Rc<Step>,
        difference: i64,
    },
    /// A call by the instruction before, on a path that is known as a tree.
    CallTree(Rc<PathTree>),
}

impl Drop for Step {
    /// Without recursion along the list, which may be long.
    fn drop(&mut self) {
        let mut next = self.before.take();
        while let Some(step) = next {
            next = Rc::try_unwrap(step)
                .ok()
                .and_then(|mut step| step.before.take());
        }
    }
}

impl Step {
    /// The instruction that makes the call of this step.
    fn calling_address(&self) -> u32 {
        let mut here = self.before.as_ref();
        while let Some(step) = here {
            if let Part::Instruction { address, .. } = step.part {
                return address;
            }
            here = step.before.as_ref();
        }
        0
    }
}

/// `cycles - from`, which may be negative.
pub fn difference(cycles: u64, from: u64) -> i64 {
    cycles.wrapping_sub(from) as i64
}

impl Elapsed {
    /// A path without steps so far.
    pub fn begin(recorded: bool) -> Self {
        let begin = || Step {
            before: None,
            part: Part::Begin,
        };
        Self {
            cycles: 0,
            last: recorded.then(|| Rc::new(begin())),
        }
    }

    /// A path without steps so far, recorded if this one is.
    pub fn restarted(&self) -> Self {
        Self::begin(self.last.is_some())
    }

    fn count(&mut self, cycles: u64) {
        self.cycles = self.cycles.saturating_add(cycles);
        if self.cycles == UNBOUNDED {
            self.last = None;
        }
    }

    fn push(&mut self, part: impl FnOnce() -> Option<Part>) {
        if self.last.is_some() {
            if let Some(part) = part() {
                let before = self.last.take();
                self.last = Some(Rc::new(Step { before, part }));
            }
        }
    }

    /// Adds cycles of the instruction at `address`, which was fetched `executions` times.
    #[inline]
    pub fn add(&mut self, address: u32, executions: u64, cycles: u64) {
        self.cycles = self.cycles.saturating_add(cycles);
        if self.last.is_some() {
            self.record(address, executions, cycles);
        }
    }

    #[cold]
    fn record(&mut self, address: u32, executions: u64, cycles: u64) {
        if let Some(Step {
            part:
                Part::Instruction {
                    address: known,
                    executions: times,
                    cycles: sum,
                },
            ..
        }) = self.last.as_mut().and_then(Rc::get_mut)
        {
            if *known == address {
                *times += executions;
                *sum += cycles;
                return;
            }
        }
        self.push(|| {
            Some(Part::Instruction {
                address,
                executions,
                cycles,
            })
        });
    }

    /// Adds the steps from `begin` to `end`, which began with it, so many times.
    pub fn add_repeated(&mut self, begin: &Self, end: &Self, times: u64) {
        let one = end.cycles.saturating_sub(begin.cycles);
        self.count(one.saturating_mul(times));
        self.push(|| {
            let last = end.last.clone()?;
            let after = begin.last.clone();
            (times > 0).then_some(Part::Repeated { after, last, times })
        });
    }

    /// The steps since `begin`, with which this path began.
    pub fn since(&self, begin: &Self) -> Self {
        let mut found = self.restarted();
        found.add_repeated(begin, self, 1);
        if self.cycles == UNBOUNDED {
            found.cycles = UNBOUNDED;
        }
        found
    }

    /// Adds another path's steps.
    pub fn add_path(&mut self, other: &Self) {
        self.add_repeated(&Self::default(), other, 1);
    }

    /// Adds a call that is charged `cycles`; its own path began with it.
    pub fn add_call(&mut self, callee: u32, own: &Self, cycles: u64) {
        self.count(cycles);
        self.push(|| {
            Some(Part::Call {
                callee,
                last: own.last.clone()?,
                difference: difference(cycles, own.cycles),
            })
        });
    }

    /// Adds a call of a function with a bound; without a tree, the cycles are the function's.
    pub fn add_bound(&mut self, callee: u32, cycles: u64, tree: Option<&Rc<PathTree>>) {
        self.count(cycles);
        self.push(|| {
            let tree = tree.cloned();
            let whole = || Rc::new(PathTree::without_steps(callee, cycles));
            Some(Part::CallTree(tree.unwrap_or_else(whole)))
        });
    }

    /// The longer of both.
    pub fn longer(&self, other: &Self) -> Self {
        if self.cycles >= other.cycles {
            self
        } else {
            other
        }
        .clone()
    }

    /// The path of one call of a function, by instructions and calls; none if not recorded.
    pub fn tree(&self, entry: u32) -> Option<PathTree> {
        let mut tree = PathTree::new(entry);
        tree.calls = 1;
        self.last.as_ref()?;
        self.add_to_tree(&mut tree, 1);
        Some(tree)
    }

    /// Adds the steps of this path to those of a function.
    pub fn add_to_tree(&self, tree: &mut PathTree, times: u64) {
        add_steps(tree, self.last.as_ref(), None, times);
    }
}

fn add_steps(
    tree: &mut PathTree,
    mut last: Option<&Rc<Step>>,
    after: Option<&Rc<Step>>,
    times: u64,
) {
    while let Some(step) = last {
        if after.is_some_and(|after| Rc::ptr_eq(after, step)) {
            return;
        }
        match &step.part {
            Part::Begin => {}
            Part::Instruction {
                address,
                executions,
                cycles,
            } => tree.add_instruction(*address, executions * times, cycles * times),
            Part::Repeated {
                after,
                last,
                times: repeated,
            } => add_steps(tree, Some(last), after.as_ref(), times * repeated),
            Part::Call {
                callee,
                last,
                difference,
            } => {
                let called = tree.callee(step.calling_address(), *callee);
                called.calls += times;
                called.difference += difference * times as i64;
                add_steps(called, Some(last), None, times);
            }
            Part::CallTree(called) => {
                let place = tree.callee(step.calling_address(), called.entry);
                place.add(called, times);
            }
        }
        last = step.before.as_ref();
    }
}
