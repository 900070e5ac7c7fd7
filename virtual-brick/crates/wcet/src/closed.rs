// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Programs that nothing else disturbs: they begin with memory as the image says, no interrupt or
//! other thread writes to it, and what they read was written by themselves. Loops, recursion and
//! branches that depend on such data only need no fact; what cannot be followed is bounded for any
//! data.

use crate::annotations::Annotations;
use crate::contents::Contents;
use crate::context::Follower;
use crate::error::Error;
use crate::image::Image;
use crate::memory::MemoryMap;
use crate::program::Program;
use crate::state::{State, ENDLESS};
use crate::value::Value;
use crate::walk::any_arguments;
use serde::Deserialize;

/// Stack of the analysis itself, which follows calls by calls of its own.
const STACK_BYTES: usize = 1 << 30;

/// Functions called one after the other.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Closed {
    /// Their names; the last one is bounded.
    pub calls: Vec<String>,
    /// Stack pointer at the calls.
    pub stack_pointer: u32,
}

impl Closed {
    /// Cycles of the last call, without the fetches after its return.
    pub fn bound(
        &self,
        image: &Image,
        map: &MemoryMap,
        annotations: &Annotations,
    ) -> Result<u64, Error> {
        let work = || {
            let mut program = Program::new(image, map, annotations)?;
            program.closed = true;
            self.run(&program)
        };
        std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
            let handle = thread.spawn_scoped(scope, work);
            let ended = handle.map(|handle| handle.join());
            match ended {
                Ok(Ok(result)) => result,
                _ => Err(Error::Input("no memory for following calls".into())),
            }
        })
    }

    fn run(&self, program: &Program<'_>) -> Result<u64, Error> {
        let mut memory = Contents::of_image(program.image);
        let mut cycles = ENDLESS;
        for name in &self.calls {
            let entry = program.function(name)?;
            let summary = program.summary(entry, entry.0)?;
            let mut state = State::entry(&any_arguments());
            state.registers[13] = Value::Constant(self.stack_pointer);
            state.lowest = None;
            state.memory = Some(memory);
            let follower = Follower::new(program, entry, true);
            let after = follower.execute(&summary, state);
            let never = || Error::NeverReturns(program.image.place(entry.0));
            let after = after.ok_or_else(never)?;
            cycles = after.elapsed.0;
            memory = after.memory.unwrap_or_default();
        }
        if cycles == ENDLESS {
            let name = self.calls.last().map_or("", String::as_str);
            return Err(Error::Input(format!(
                "{name}: not all of its ways could be followed; bound it for any data"
            )));
        }
        Ok(cycles)
    }
}
