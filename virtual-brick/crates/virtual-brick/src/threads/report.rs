// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The threads as they are now.

use crate::stacks::Stack;

use super::observer::{Created, ThreadObserver};
use super::Memory;

/// A thread of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thread {
    /// Name given by the program, or that of the object that holds the control block; empty
    /// when neither is known.
    pub name: String,
    /// Base priority.
    pub base_priority: u32,
    /// Lowest address of the stack.
    pub stack_base: u32,
    /// Bytes of the stack.
    pub stack_size: u32,
    /// Bytes used so far: from the lowest byte that is not zero to the top.
    pub stack_used: u32,
    /// Address of the control block.
    pub address: u32,
    /// State: 0 unstarted, 1 ready, 2 delayed, 3 suspended, 4 blocked on an entry, 5 terminated.
    pub state: u32,
}

impl ThreadObserver {
    /// All threads; the position is the index that events use.
    pub(crate) fn report(&self, memory: &impl Memory) -> Vec<Thread> {
        self.threads
            .iter()
            .map(|thread| {
                let field = |offset: u32| {
                    memory
                        .word(thread.address.wrapping_add(offset))
                        .unwrap_or(0)
                };
                let shown = Created {
                    name: self.names.of(thread.address, memory).unwrap_or_default(),
                    base_priority: field(self.layout.base_priority),
                    stack: Stack {
                        base: field(self.layout.stack_base),
                        size: field(self.layout.stack_size),
                    },
                };
                // A control block with another stack was overwritten.
                let created = thread.created.clone();
                let shown = created.filter(|c| c.stack != shown.stack).unwrap_or(shown);
                Thread {
                    name: shown.name,
                    base_priority: shown.base_priority,
                    stack_base: shown.stack.base,
                    stack_size: shown.stack.size,
                    stack_used: stack_used(memory, shown.stack),
                    address: thread.address,
                    state: thread.state,
                }
            })
            .collect()
    }
}

/// A stack that is no memory (fields not yet written) counts as unused.
fn stack_used(memory: &impl Memory, Stack { base, size }: Stack) -> u32 {
    const RAM_LENGTH: u32 = 65_536;
    if size > RAM_LENGTH {
        return 0;
    }
    let mut bytes = vec![0; size as usize];
    if !memory.read(base, &mut bytes) {
        return 0;
    }
    bytes
        .iter()
        .position(|&byte| byte != 0)
        .map_or(0, |lowest| size - lowest as u32)
}
