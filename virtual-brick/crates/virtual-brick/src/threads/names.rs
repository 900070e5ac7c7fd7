// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Names of threads: the one that the control block gives, else the object that holds the block.

use std::sync::Arc;

use image::Image;

use super::layout::Layout;
use super::Memory;

const LENGTH_MAX: u32 = 128;

/// Where names come from.
#[derive(Clone, Debug)]
pub(super) struct ThreadNames {
    pub layout: Layout,
    pub image: Option<Arc<Image>>,
}

impl ThreadNames {
    /// Name of the thread with this control block; none when nothing tells it.
    pub(super) fn of(&self, block: u32, memory: &impl Memory) -> Option<String> {
        self.given(block, memory).or_else(|| self.of_object(block))
    }

    /// The text that the control block points to, when it is printable.
    fn given(&self, block: u32, memory: &impl Memory) -> Option<String> {
        let address = memory.word(block.wrapping_add(self.layout.name_address))?;
        let length = memory.word(block.wrapping_add(self.layout.name_length))?;
        if address == 0 || length == 0 || length > LENGTH_MAX {
            return None;
        }
        let mut bytes = vec![0; length as usize];
        let printable = memory.read(address, &mut bytes)
            && bytes
                .iter()
                .all(|byte| byte.is_ascii_graphic() || *byte == b' ');
        printable.then(|| String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The compiler puts a control block into the task object: its simple name, without the
    /// packages, which the linker name joins by two underscores.
    fn of_object(&self, block: u32) -> Option<String> {
        let name = self.image.as_ref()?.symbols().object_at(block)?;
        Some(name.rsplit("__").next().unwrap_or(name).to_owned())
    }
}
