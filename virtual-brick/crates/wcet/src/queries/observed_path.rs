// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The path of a run, from the sequence of its instructions: which function calls which.

use crate::elapsed::PathTree;
use crate::graph::control_flow::is_helper;
use crate::inputs::image::Image;
use crate::inputs::memory_map::MemoryMap;
use arm7tdmi::instruction::{Instruction, Operation};

/// A function that has not returned.
struct Open {
    tree: PathTree,
    /// The instruction that called it.
    called_at: u32,
    /// The function around its last instruction, which a branch may have reached.
    inside: u32,
}

struct Follower<'a> {
    image: &'a Image,
    map: &'a MemoryMap,
    open: Vec<Open>,
}

/// The tree of a run's instructions: address and cycles of each. The first ones may belong to
/// functions that return to the one whose tree it is. As in a bound, the fetches after a return
/// belong to the call.
pub fn observed_path(image: &Image, map: &MemoryMap, steps: &[(u32, u64)]) -> PathTree {
    let mut follower = Follower {
        image,
        map,
        open: Vec::new(),
    };
    let mut before = 0;
    for (address, cycles) in steps {
        // A veneer between the states is part of its caller: what it leads to is called there.
        if !follower.is_in_veneer(*address) {
            follower.arrive(before, *address);
            before = *address;
        }
        if let Some(here) = follower.open.last_mut() {
            here.tree.add_instruction(*address, 1, *cycles);
        }
    }
    while follower.open.len() > 1 {
        follower.leave();
    }
    let whole = follower.open.pop().map(|open| open.tree);
    whole.unwrap_or_default()
}

/// Does the instruction at `next` follow the one at `address`?
fn follows(next: u32, address: u32) -> bool {
    matches!(next.wrapping_sub(address), 2 | 4)
}

impl Follower<'_> {
    /// The entry of the function around an address; none for code without a name, such as the end
    /// of an interrupt.
    fn function_at(&self, address: u32) -> Option<u32> {
        let (_, offset) = self.image.place(address).symbol?;
        Some(address - offset)
    }

    fn is_in_veneer(&self, address: u32) -> bool {
        let entry = self.function_at(address);
        entry.is_some_and(|entry| is_helper(self.image, entry))
    }

    fn is_thumb(&self, address: u32) -> bool {
        self.image.instruction(address, false).is_none()
    }

    /// Is the instruction a branch to an address that it contains, or none at all?
    fn stays(&self, before: u32, address: u32) -> bool {
        let instruction = self.image.instruction(before, self.is_thumb(before));
        let branch = |i: Instruction| matches!(i.operation, Operation::Branch { .. });
        follows(address, before) || instruction.is_some_and(branch)
    }

    fn begin(&mut self, function: u32, called_at: u32) {
        let mut tree = PathTree::new(function);
        tree.calls = 1;
        self.open.push(Open {
            tree,
            called_at,
            inside: function,
        });
    }

    /// The innermost function has ended.
    fn leave(&mut self) {
        if let Some(Open {
            tree, called_at, ..
        }) = self.open.pop()
        {
            if let Some(caller) = self.open.last_mut() {
                caller.tree.callee(called_at, tree.entry).add(&tree, 1);
            }
        }
    }

    /// Control goes from one instruction to another.
    fn arrive(&mut self, before: u32, address: u32) {
        let Some(function) = self.function_at(address) else {
            return;
        };
        let stays = self.stays(before, address);
        let caller = self.caller_of(function, address);
        let Some(here) = self.open.last_mut() else {
            self.begin(function, before);
            return;
        };
        if let Some(depth) = caller {
            self.return_to(depth, before, address);
        } else if here.inside == function {
            // It goes on.
        } else if function == address && !follows(address, before) {
            self.begin(function, before);
        } else if stays {
            here.inside = function;
        } else {
            self.return_to_unseen(function, before, address);
        }
    }

    /// The open function that goes on at an address, behind its call.
    fn caller_of(&self, function: u32, address: u32) -> Option<usize> {
        let goes_on =
            |pair: &[Open]| pair[0].inside == function && follows(address, pair[1].called_at);
        self.open.windows(2).rposition(goes_on)
    }

    fn return_to(&mut self, depth: usize, before: u32, address: u32) {
        let refill = self.take_refill(before, address);
        let mut called_at = before;
        while self.open.len() > depth + 1 {
            called_at = self.open.last().map_or(called_at, |open| open.called_at);
            self.leave();
        }
        self.add_refill(called_at, refill);
    }

    /// Back into a function that was called before the first instruction.
    fn return_to_unseen(&mut self, function: u32, before: u32, address: u32) {
        let refill = self.take_refill(before, address);
        while self.open.len() > 1 {
            self.leave();
        }
        let inner = self.open.pop();
        self.begin(function, address);
        // The call is the instruction before; four bytes in both states, if it is one.
        let called_at = address.wrapping_sub(4);
        if let (Some(inner), Some(outer)) = (inner, self.open.last_mut()) {
            let callee = outer.tree.callee(called_at, inner.tree.entry);
            callee.add(&inner.tree, 1);
        }
        self.add_refill(called_at, refill);
    }

    /// Takes the fetches after a return from its last instruction.
    fn take_refill(&mut self, before: u32, address: u32) -> u64 {
        let refill = self.map.refill(address, self.is_thumb(address));
        let last = self.open.last_mut();
        let own = last.and_then(|open| open.tree.instructions.get_mut(&before));
        own.map_or(0, |(_, cycles)| {
            let taken = refill.unwrap_or(0).min(*cycles);
            *cycles -= taken;
            taken
        })
    }

    fn add_refill(&mut self, called_at: u32, cycles: u64) {
        if let Some(here) = self.open.last_mut() {
            let known = here.tree.instructions.entry(called_at).or_default();
            known.1 += cycles;
        }
    }
}
