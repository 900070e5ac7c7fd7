// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Chains of calls, innermost first, and their places in the sources.

use image::Image;

const DEPTH_MAX: usize = 64;
const LINK: usize = 14;
const PROGRAM_COUNTER: usize = 15;

/// A place in the code that is being executed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Call {
    pub symbol: String,
    /// Path of the source, line and column; none without debug information.
    pub line: Option<(String, u32, u32)>,
}

impl Call {
    /// Code of the run-time: of no interest to who wrote the program.
    fn in_run_time(&self) -> bool {
        const PREFIXES: [&str; 5] = ["ravenbrick_", "system__", "ada__", "__", "_gnat_"];
        PREFIXES
            .iter()
            .any(|prefix| self.symbol.starts_with(prefix))
    }

    fn in_driver(&self) -> bool {
        self.symbol.starts_with("nxt__")
    }

    /// `tasks.adb:57`.
    fn place(&self) -> Option<String> {
        let (file, line, _) = self.line.as_ref()?;
        let name = file.rsplit('/').next().unwrap_or(file);
        Some(format!("{name}:{line}"))
    }
}

/// The calls that lead to `registers[15]`, inside of an instruction; `word` reads memory.
pub(crate) fn chain(
    image: &Image,
    registers: [u32; 16],
    word: impl Fn(u32) -> Option<u32>,
) -> Vec<Call> {
    located(image, &addresses(image, registers, word))
}

/// The places at these addresses.
pub(crate) fn located(image: &Image, addresses: &[u32]) -> Vec<Call> {
    let lines = image.lines();
    let call = |&address: &u32| {
        let (symbol, _) = image.symbols().nearest_code(address)?;
        let line = lines.at(address);
        Some(Call {
            symbol: symbol.to_owned(),
            line: line.map(|at| (at.file.to_owned(), at.line, at.column)),
        })
    };
    addresses.iter().filter_map(call).collect()
}

/// As [`chain`], the addresses alone.
pub(crate) fn addresses(
    image: &Image,
    mut registers: [u32; 16],
    word: impl Fn(u32) -> Option<u32>,
) -> Vec<u32> {
    let frames = image.frames();
    let mut address = registers[PROGRAM_COUNTER];
    let mut addresses = vec![address];
    while addresses.len() < DEPTH_MAX {
        let caller = frames.caller(&registers, address, &word);
        // What has no frame information keeps the way back in its register.
        let leaf = addresses.len() == 1 && registers[LINK] != registers[PROGRAM_COUNTER];
        registers = match caller {
            Some(caller) => caller,
            None if leaf => {
                registers[PROGRAM_COUNTER] = registers[LINK];
                registers
            }
            None => break,
        };
        address = before_return(registers[PROGRAM_COUNTER]);
        addresses.push(address);
    }
    addresses
}

/// An address inside of the call that returns to `address`.
pub(crate) const fn before_return(address: u32) -> u32 {
    (address & !1).wrapping_sub(2)
}

/// The innermost line outside of the run-time.
pub(crate) fn innermost(calls: &[Call]) -> Option<&(String, u32, u32)> {
    calls
        .iter()
        .find(|call| call.line.is_some() && !call.in_run_time())?
        .line
        .as_ref()
}

/// `tasks.adb:57`, or `nxt-lcd.adb:80, called from tasks.adb:57`; none where no line is known.
pub(crate) fn place(calls: &[Call]) -> Option<String> {
    let mut own = calls
        .iter()
        .filter(|call| call.line.is_some() && !call.in_run_time());
    let first = own.next()?;
    let mut place = first.place()?;
    if first.in_driver() {
        if let Some(user) = own.find(|call| !call.in_driver()).and_then(Call::place) {
            place = format!("{place}, called from {user}");
        }
    }
    Some(place)
}

/// The innermost line outside of run-time and drivers, else as [`place`].
pub(crate) fn user_place(calls: &[Call]) -> Option<String> {
    let mut own = calls
        .iter()
        .filter(|call| !call.in_run_time() && !call.in_driver());
    own.find_map(Call::place).or_else(|| place(calls))
}

/// The part of the environment task that the calls are of: its tasks do not have names.
pub(crate) fn environment(calls: &[Call]) -> String {
    for call in calls {
        let unit = ["___elabb", "___elabs"]
            .iter()
            .find_map(|end| call.symbol.strip_suffix(end));
        if let Some(unit) = unit {
            return format!("the elaboration of package '{}'", unit.replace("__", "."));
        }
    }
    "the main procedure".to_owned()
}
