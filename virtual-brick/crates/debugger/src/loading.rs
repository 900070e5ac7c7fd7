// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Programs that come from GDB: `load` into RAM is writing memory; flash is erased and written
//! here; `monitor program` begins again with the program of a file.

use std::fs::{self, File};
use std::io::Read;

use gdbstub::target::ext::flash::Flash;
use gdbstub::target::{TargetError, TargetResult};

use crate::execution::Job;
use crate::target::DebugTarget;
use crate::tasks::Context;
use crate::timeline::{Change, Timeline};

const FLASH: u32 = 0x0010_0000;
const FLASH_BYTES: u32 = 0x0004_0000;
const ERASED: u8 = 0xFF;
/// A program with its debug information is far smaller.
const FILE_BYTES_MAX: u64 = 1 << 26;

fn in_flash(address: u32, length: usize) -> TargetResult<(), DebugTarget> {
    let offset = u64::from(address.wrapping_sub(FLASH));
    if offset + length as u64 <= u64::from(FLASH_BYTES) {
        Ok(())
    } else {
        Err(TargetError::NonFatal)
    }
}

impl Flash for DebugTarget {
    fn flash_erase(&mut self, start_addr: u32, length: u32) -> TargetResult<(), Self> {
        in_flash(start_addr, length as usize)?;
        self.change(Change::Memory {
            address: start_addr,
            bytes: vec![ERASED; length as usize],
        })
    }

    fn flash_write(&mut self, start_addr: u32, data: &[u8]) -> TargetResult<(), Self> {
        in_flash(start_addr, data.len())?;
        self.change(Change::Memory {
            address: start_addr,
            bytes: data.to_vec(),
        })
    }

    fn flash_done(&mut self) -> TargetResult<(), Self> {
        Ok(())
    }
}

fn read(path: &str) -> Result<Vec<u8>, String> {
    let failed = |error: std::io::Error| format!("{path}: {error}");
    let found = fs::metadata(path).map_err(failed)?;
    if !found.is_file() || found.len() > FILE_BYTES_MAX {
        return Err(format!("{path}: is no ELF file of a program"));
    }
    let mut content = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(FILE_BYTES_MAX)
        .read_to_end(&mut content)
        .map_err(failed)?;
    Ok(content)
}

/// Begin again with the program of a file on this machine.
pub(crate) fn program(target: &mut DebugTarget, path: &str) -> Result<(), String> {
    if target.timeline.beginning() != 0 {
        return Err("the record does not begin at power-on; start the server again".to_owned());
    }
    let content = read(path)?;
    target.timeline.reset();
    let brick = target.timeline.brick().with_program(&content);
    let mut brick = brick.map_err(|error| format!("{path}: {error}"))?;
    brick.set_semihosting(true);
    target.stopped = Context::now(&brick).tid(&brick);
    target.timeline = Timeline::new(brick);
    target.job = Job::Nothing;
    Ok(())
}
