// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Names of the subjects of events: an index per name, in the order of first use.

/// Subjects are numbered separately in each space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameSpace {
    /// Threads of the run-time.
    Thread,
    /// Inputs of the brick.
    Input,
    /// Motors.
    Motor,
}

impl NameSpace {
    pub(crate) const ALL: [Self; 3] = [Self::Thread, Self::Input, Self::Motor];
}

/// The table of names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    threads: Vec<String>,
    inputs: Vec<String>,
    motors: Vec<String>,
}

impl Names {
    /// All names of a space; the position is the index.
    #[must_use]
    pub fn all(&self, space: NameSpace) -> &[String] {
        match space {
            NameSpace::Thread => &self.threads,
            NameSpace::Input => &self.inputs,
            NameSpace::Motor => &self.motors,
        }
    }

    /// Index of `name`; it is added at the end when new.
    pub fn intern(&mut self, space: NameSpace, name: &str) -> u32 {
        let names = self.column(space);
        let index = names
            .iter()
            .position(|known| known == name)
            .unwrap_or_else(|| {
                names.push(name.to_owned());
                names.len() - 1
            });
        index as u32
    }

    /// Add a name that may occur twice (two threads of one task type): always a new index.
    pub fn add(&mut self, space: NameSpace, name: &str) -> u32 {
        let names = self.column(space);
        names.push(name.to_owned());
        (names.len() - 1) as u32
    }

    /// Give index `index` another name; an index never given is ignored.
    pub fn rename(&mut self, space: NameSpace, index: u32, name: &str) {
        if let Some(old) = self.column(space).get_mut(index as usize) {
            name.clone_into(old);
        }
    }

    fn column(&mut self, space: NameSpace) -> &mut Vec<String> {
        match space {
            NameSpace::Thread => &mut self.threads,
            NameSpace::Input => &mut self.inputs,
            NameSpace::Motor => &mut self.motors,
        }
    }
}
