// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What an operating kernel's code means beyond its instructions: where the running thread is
//! named, how a thread gives up the processor, how it enters and leaves protected actions.
//!
//! A thread that gives up the processor leaves on top of its stack the address at which it goes
//! on, and takes another stack pointer. For that thread, the next instruction executed is the one
//! at this address, with its stack as it was and every other register changed.

use crate::inputs::annotations::Annotations;
use crate::inputs::image::Image;
use std::collections::{BTreeMap, BTreeSet};

/// Resolved to addresses.
#[derive(Clone, Debug, Default)]
pub struct KernelConventions {
    /// Address of the word that names the running thread; its first word is its urgency.
    pub running: Option<u32>,
    /// Functions that take the processor from the thread which jumps to them.
    pub context_switches: BTreeSet<u32>,
    /// Functions that enter the protected object given in r0.
    pub locks: BTreeSet<u32>,
    /// Functions that leave the protected action of their caller.
    pub unlocks: BTreeSet<u32>,
    /// Functions that undo what one of `locks` did.
    pub unmasks: BTreeSet<u32>,
    /// Offset of the word of an object that, when not zero, says that it needs none of `locks`.
    pub span_offset: Option<u32>,
    /// Words of writable memory that no longer change while the program runs.
    pub words: BTreeMap<u32, u32>,
}

impl KernelConventions {
    /// Those of the annotations whose functions the image has.
    pub fn new(image: &Image, annotations: &Annotations) -> Self {
        let addresses = |names: &[String]| {
            let found = names.iter().filter_map(|name| image.function(name));
            found.map(|(address, _)| address).collect()
        };
        let kernel = &annotations.kernel;
        Self {
            running: kernel.running_thread,
            context_switches: addresses(&kernel.context_switches),
            locks: addresses(&kernel.locks),
            unlocks: addresses(&kernel.unlocks),
            unmasks: addresses(&kernel.unmasks),
            span_offset: kernel.span_offset,
            words: annotations
                .words
                .iter()
                .map(|word| (word.address, word.value))
                .collect(),
        }
    }

    /// Is this object known never to be entered by one of `locks`?
    pub fn never_locked(&self, object: Option<u32>) -> bool {
        let word = object
            .zip(self.span_offset)
            .and_then(|(object, offset)| self.words.get(&object.wrapping_add(offset)));
        word.is_some_and(|span| *span != 0)
    }
}
