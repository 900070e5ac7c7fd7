// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The only `unsafe` code: memory with JIT code, and calls into it.
//!
//! Why the calls are sound:
//!
//! - The code called was compiled by this crate's [compiler](crate::compiler) for this signature
//!   and names no address of its own, is finished before its address is used, and lies in memory
//!   that is freed only with the [`CodeMemory`], which is borrowed during the call.
//!   [`CodeAddress`] cannot be made elsewhere, and [`CodeMemory::clear`] is called together with
//!   the removal of all entries that name code.
//! - It accesses four things: the state, which is borrowed mutably and has a fixed layout; the
//!   words of RAM, borrowed mutably, and their marks, borrowed, both of the length that is
//!   compared before each call with the length the code was compiled for, and with each offset
//!   compared with that length before its access; and the table of entries, which belongs to the
//!   caller, is borrowed during the call, does not move while there is code that names it, and is
//!   only read.
//! - It keeps none of the addresses, calls nothing but other code of the same memory, and does
//!   not unwind.
#![allow(unsafe_code)]

use std::mem;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

use arm7tdmi::GuestState;
use cranelift_codegen::ir::Signature;
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use cranelift_module::{default_libcall_names, Module};

use crate::entry_table::Entry;
use crate::host_code::{entry_signature, region_signature, HostCode};

/// The entry function: from the host's calling convention to that of regions.
type EntryFunction =
    unsafe extern "C" fn(*mut GuestState, u32, *mut u32, *const u8, u32, *const u8) -> u32;

/// Address of finished code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CodeAddress(usize);

impl CodeAddress {
    pub const fn value(self) -> usize {
        self.0
    }
}

/// Addresses that the code of one engine can take; memory is taken for what is used.
pub(crate) const ARENA_BYTES: usize = 8 << 20;
/// What is finished together has pages of its own, of at least so many bytes.
const PAGE_BYTES: usize = 4096;
/// Arenas of the process. Each is at most three mappings (code, written, reserved); hosts allow
/// some 65,000.
const ARENAS_MAX: usize = 8192;
static ARENAS: AtomicUsize = AtomicUsize::new(0);

/// Cranelift's memory, in an arena.
struct Memory(JITModule);

// SAFETY: all but the provider of memory is `Send`. That is an arena made for this module alone:
// it owns its pages, its pointers lead to them, and nothing in it belongs to a thread.
unsafe impl Send for Memory {}

impl Memory {
    /// None where the process has too many already, or the host gives no addresses.
    fn new(isa: &OwnedTargetIsa) -> Option<Self> {
        if ARENAS.fetch_add(1, Ordering::Relaxed) < ARENAS_MAX {
            if let Ok(arena) = ArenaMemoryProvider::new_with_size(ARENA_BYTES) {
                let mut builder = JITBuilder::with_isa(isa.clone(), default_libcall_names());
                builder.memory_provider(Box::new(arena));
                return Some(Self(JITModule::new(builder)));
            }
        }
        ARENAS.fetch_sub(1, Ordering::Relaxed);
        None
    }
}

/// Executable memory with finished code.
pub(crate) struct CodeMemory {
    isa: OwnedTargetIsa,
    /// None before the first code. The lock is never taken: it only makes the module shareable.
    module: Option<Mutex<Memory>>,
    entry_function: Option<EntryFunction>,
    /// Whole pages.
    bytes: usize,
}

impl Drop for CodeMemory {
    fn drop(&mut self) {
        self.clear();
    }
}

/// The compiler's back end for the host; none where it has none.
pub(crate) fn host_isa() -> Option<OwnedTargetIsa> {
    static HOST: OnceLock<Option<OwnedTargetIsa>> = OnceLock::new();
    HOST.get_or_init(find_host_isa).clone()
}

fn find_host_isa() -> Option<OwnedTargetIsa> {
    let mut flags = settings::builder();
    for (name, value) in [
        ("opt_level", "none"),
        ("is_pic", "false"),
        ("enable_verifier", if cfg!(test) { "true" } else { "false" }),
        ("enable_probestack", "false"),
        ("preserve_frame_pointers", "true"),
        ("unwind_info", "false"),
    ] {
        flags.set(name, value).ok()?;
    }
    let builder = cranelift_native::builder().ok()?;
    builder.finish(settings::Flags::new(flags)).ok()
}

impl CodeMemory {
    pub fn new(isa: OwnedTargetIsa) -> Self {
        Self {
            isa,
            module: None,
            entry_function: None,
            bytes: 0,
        }
    }

    pub fn isa(&self) -> &OwnedTargetIsa {
        &self.isa
    }

    /// Bytes of the pages with the code of regions.
    pub const fn bytes(&self) -> usize {
        self.bytes
    }

    /// Frees all code.
    pub fn clear(&mut self) {
        self.entry_function = None;
        self.bytes = 0;
        if let Some(Ok(Memory(module))) = self.module.take().map(Mutex::into_inner) {
            // SAFETY: no address of the code is called again: the entry function is gone, entries
            // with addresses are removed by whoever calls this, and code runs only while this
            // memory is borrowed.
            unsafe { module.free_memory() }
            ARENAS.fetch_sub(1, Ordering::Relaxed);
        }
    }

    pub const fn has_entry_function(&self) -> bool {
        self.entry_function.is_some()
    }

    /// Takes the function through which regions are entered, of [`entry_signature`].
    pub fn define_entry_function(&mut self, code: &HostCode) -> Option<()> {
        let address = self.place(&entry_signature(&self.isa), code)?;
        // SAFETY: the function has this signature in the host's calling convention, and stays
        // until `entry_function` is reset.
        let function = unsafe { mem::transmute::<*const u8, EntryFunction>(address) };
        self.entry_function = Some(function);
        Some(())
    }

    /// Takes the code of a region, of [`region_signature`].
    pub fn define_region(&mut self, code: &HostCode) -> Option<CodeAddress> {
        self.bytes += code.bytes.len().next_multiple_of(PAGE_BYTES);
        let address = self.place(&region_signature(), code)?;
        Some(CodeAddress(address as usize))
    }

    fn place(&mut self, signature: &Signature, code: &HostCode) -> Option<*const u8> {
        if self.module.is_none() {
            self.module = Some(Mutex::new(Memory::new(&self.isa)?));
        }
        let module = &mut self.module.as_mut()?.get_mut().ok()?.0;
        let function = module.declare_anonymous_function(signature).ok()?;
        let HostCode { bytes, alignment } = code;
        module
            .define_function_bytes(function, *alignment, bytes, &[])
            .ok()?;
        module.finalize_definitions().ok()?;
        Some(module.get_finalized_function(function))
    }

    /// Runs the code at an entry of the table: the number of the exit.
    #[inline]
    pub fn run(
        &mut self,
        entry: &Entry,
        _table: &[Entry],
        state: &mut GuestState,
        words: &mut [u32],
        marks: &[u8],
    ) -> Option<u32> {
        let enter = self.entry_function?;
        let (left, code) = (state.cycles_left, entry[1] as *const u8);
        let index = (entry[0] >> 48) as u32;
        // SAFETY: see the top of the file.
        Some(unsafe { enter(state, left, words.as_mut_ptr(), marks.as_ptr(), index, code) })
    }
}
