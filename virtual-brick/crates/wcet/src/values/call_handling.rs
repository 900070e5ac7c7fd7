// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The call at the end of a block: which functions it reaches in a state, what it does to the
//! state, and which protected actions it enters and leaves.

use crate::inputs::image::Entry;
use crate::values::block_interpreter::{deeper, BlockInterpreter, CallOutcome};
use crate::values::state::{enter, State, ANY_URGENCY};
use crate::values::support_library::{apply_division, division};
use crate::values::value::Value;
use std::collections::BTreeSet;

impl BlockInterpreter<'_> {
    /// The state after the call at the end of a block; none when it does not return.
    pub(super) fn call(
        &mut self,
        index: usize,
        address: u32,
        targets: Option<&[u32]>,
        mut state: State,
    ) -> Option<State> {
        let callees = self.possible_callees(index, targets, &state);
        self.track_masks(&callees, &mut state);
        let urgencies = self.record_call(index, &callees, &state);
        let Some(calls) = self.calls.filter(|_| !callees.is_empty()) else {
            state.urgencies = urgencies;
            self.apply_unknown_callee(index, address, &mut state);
            return (!callees.is_empty()).then_some(state);
        };
        let before = state.elapsed.clone();
        let depth = state.depth_bytes();
        let mut deepest = Some(0);
        let (number, divisor) = (&state.registers[0], &state.registers[1]);
        let divided = division(self.environment.image, &callees, (number, divisor));
        let mut after: Option<State> = None;
        let mut state = Some(state);
        for (position, callee) in callees.iter().enumerate() {
            let last = position + 1 == callees.len();
            let own = if last { state.take() } else { state.clone() };
            let (found, bytes) = match calls.call(*callee, own?) {
                CallOutcome::Returns(found, bytes) => (found, bytes),
                CallOutcome::NeverReturns => continue,
                CallOutcome::Bounded(mut state, bytes) => {
                    self.apply_unknown_callee(index, address, &mut state);
                    (state, bytes)
                }
            };
            deepest = deeper(deepest, depth.zip(bytes).map(|(here, below)| here + below));
            after = Some(match after {
                Some(known) => known.join(&found),
                None => found,
            });
        }
        let mut after = after?;
        self.deepest_bytes = deeper(self.deepest_bytes, deepest);
        after.urgencies = urgencies;
        if let Some(results) = divided {
            apply_division(&mut after.registers, results);
        }
        if let Some(record) = self.records.get_mut(index) {
            record.callee_depth_bytes = deeper(record.callee_depth_bytes, deepest);
            let elapsed = after.elapsed.since(&before);
            record.callee_elapsed = Some(match record.callee_elapsed.take() {
                Some(known) => known.longer(&elapsed),
                None => elapsed,
            });
        }
        Some(after)
    }

    /// The functions that a call can reach in this state.
    fn possible_callees(&self, index: usize, targets: Option<&[u32]>, state: &State) -> Vec<Entry> {
        let conventions = self.environment.conventions;
        let calls = &self.flow.blocks[index].calls;
        let named = |callee: &Entry| {
            let found = targets.is_none_or(|t| t.iter().any(|target| target & !1 == callee.0));
            found || calls.len() == 1
        };
        let spared = |callee: &Entry| {
            let locks = conventions.locks.contains(&callee.0);
            locks && conventions.never_locked(state.registers[0].constant())
                || state.mask_count == Some(0) && conventions.unmasks.contains(&callee.0)
        };
        let reached = calls
            .iter()
            .filter(|callee| named(callee) && !spared(callee));
        reached.copied().collect()
    }

    fn track_masks(&self, callees: &[Entry], state: &mut State) {
        let conventions = self.environment.conventions;
        let is_one = |set: &BTreeSet<u32>| callees.iter().any(|callee| set.contains(&callee.0));
        if is_one(&conventions.locks) {
            state.mask_count = state.mask_count.map(|mask_count| mask_count + 1);
        } else if is_one(&conventions.unmasks) {
            state.mask_count = state
                .mask_count
                .and_then(|mask_count| mask_count.checked_sub(1));
        }
    }

    /// Records arguments, depth and protected actions of a call; the urgencies after it.
    fn record_call(&mut self, index: usize, callees: &[Entry], state: &State) -> Vec<u32> {
        let conventions = self.environment.conventions;
        let mut entered = None;
        let mut after = state.urgencies.clone();
        for (callee, _) in callees {
            if conventions.locks.contains(callee) {
                let object = state.registers[0].constant();
                let urgency = object.and_then(|object| conventions.words.get(&object));
                let urgency = urgency.copied().unwrap_or(ANY_URGENCY);
                enter(&mut after, urgency);
                entered = Some(urgency);
            } else if conventions.unlocks.contains(callee) {
                after.pop();
            }
        }
        if let Some(record) = self.records.get_mut(index) {
            let arguments: [Value; 4] = std::array::from_fn(|n| state.registers[n].clone());
            let joined = match record.arguments.take() {
                Some(known) => std::array::from_fn(|n| known[n].join(&arguments[n])),
                None => arguments,
            };
            record.arguments = Some(joined);
            record.callees.extend(callees);
            record.call_depth_bytes = deeper(record.call_depth_bytes, state.depth_bytes());
            record.urgency = record.urgency.max(entered);
        }
        after
    }

    /// After a call of which only the changed registers are known.
    fn apply_unknown_callee(&self, index: usize, address: u32, state: &mut State) {
        let calls = &self.flow.blocks[index].calls;
        let known = calls.iter().filter_map(|callee| self.changed.get(callee));
        state.havoc_call(known.fold(0, |all, changed| all | changed));
        if state.registers[0] == Value::Top {
            state.set_unknown(0, address);
        }
    }
}
