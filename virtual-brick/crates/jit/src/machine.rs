// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The only `unsafe` code: memory with instructions of the host, and calls into it.
//!
//! Why the calls are sound:
//!
//! - The code called was made by this crate's [compiler](crate::compiler) for this signature and
//!   names no place of its own, is finished before its address is known to anybody, and lies in
//!   memory that is freed only with the [`Machine`], which is borrowed during the call. [`Code`]
//!   cannot be made elsewhere, and [`Machine::clear`] is called together with the removal of all
//!   entries that name code.
//! - It accesses four things: the state, which is borrowed mutably and has a fixed layout; the
//!   words of RAM, borrowed mutably, and their marks, borrowed, both of the length that is
//!   compared before each call with the length the code was made for, and with each offset
//!   compared with that length before its access; and the table of entries, which belongs to the
//!   caller, is borrowed during the call, does not move while there is code that names it, and is
//!   only read.
//! - It keeps none of the addresses, calls nothing but other code of the same machine, and does
//!   not unwind.
#![allow(unsafe_code)]

use std::mem;
use std::sync::{Mutex, OnceLock};

use arm7tdmi::NativeState;
use cranelift_codegen::ir::{types, AbiParam, Signature};
use cranelift_codegen::isa::{CallConv, OwnedTargetIsa};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{default_libcall_names, Module};

use crate::compiler::Instructions;
use crate::table::Entry;

/// From the host's calling convention to that of the code. The last argument is the code.
type Enter =
    unsafe extern "C" fn(*mut NativeState, u32, *mut u32, *const u8, u32, *const u8) -> u32;

/// Address of finished code of one machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Code(usize);

impl Code {
    pub const fn address(self) -> usize {
        self.0
    }
}

/// What the compiler made.
struct Memory(JITModule);

// SAFETY: all but the provider of memory is `Send`. That is the module's own, since no other was
// given: it owns what it allocates, and nothing in it belongs to a thread.
unsafe impl Send for Memory {}

/// Memory with code.
pub(crate) struct Machine {
    isa: OwnedTargetIsa,
    /// None before the first code. The lock is never taken: it only makes the module shareable.
    module: Option<Mutex<Memory>>,
    enter: Option<Enter>,
    bytes: usize,
}

impl Drop for Machine {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Settings of the compiler; none where it has no back end for the host.
pub(crate) fn host() -> Option<OwnedTargetIsa> {
    static HOST: OnceLock<Option<OwnedTargetIsa>> = OnceLock::new();
    HOST.get_or_init(find_host).clone()
}

fn find_host() -> Option<OwnedTargetIsa> {
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

impl Machine {
    pub fn new(isa: OwnedTargetIsa) -> Self {
        Self {
            isa,
            module: None,
            enter: None,
            bytes: 0,
        }
    }

    pub fn isa(&self) -> &OwnedTargetIsa {
        &self.isa
    }

    /// Bytes of the code of regions.
    pub const fn bytes(&self) -> usize {
        self.bytes
    }

    /// Parameters of a region's code: state, cycles left, words, marks, number of the block to
    /// begin with. Results: cycles left, number of the exit.
    pub fn signature() -> Signature {
        let mut signature = Signature::new(CallConv::Tail);
        let parameters = [types::I64, types::I32, types::I64, types::I64, types::I32];
        signature.params.extend(parameters.map(AbiParam::new));
        signature.returns = vec![AbiParam::new(types::I32), AbiParam::new(types::I32)];
        signature
    }

    /// Of [`Enter`].
    pub fn enter_signature(isa: &OwnedTargetIsa) -> Signature {
        let mut signature = Signature::new(isa.default_call_conv());
        let parameters = [types::I64, types::I32, types::I64, types::I64, types::I32];
        signature.params.extend(parameters.map(AbiParam::new));
        signature.params.push(AbiParam::new(types::I64));
        signature.returns = vec![AbiParam::new(types::I32)];
        signature
    }

    /// Forgets all code and gives its memory back.
    pub fn clear(&mut self) {
        self.enter = None;
        self.bytes = 0;
        if let Some(Ok(Memory(module))) = self.module.take().map(Mutex::into_inner) {
            // SAFETY: no address of the code is called again: `enter` is gone, entries with
            // addresses are removed by whoever calls this, and code runs only while the machine
            // is borrowed.
            unsafe { module.free_memory() }
        }
    }

    /// Is there code to enter others through?
    pub const fn can_enter(&self) -> bool {
        self.enter.is_some()
    }

    /// Takes a function with [`Machine::enter_signature`] to enter others through.
    pub fn define_enter(&mut self, instructions: &Instructions) -> Option<()> {
        let signature = Self::enter_signature(&self.isa);
        let code = self.placed(&signature, instructions)?;
        // SAFETY: the function has this signature in the host's calling convention, and stays
        // until `enter` is reset.
        self.enter = Some(unsafe { mem::transmute::<*const u8, Enter>(code) });
        Some(())
    }

    /// Takes a function with [`Machine::signature`].
    pub fn define(&mut self, instructions: &Instructions) -> Option<Code> {
        let code = self.placed(&Self::signature(), instructions)?;
        self.bytes += instructions.bytes.len();
        Some(Code(code as usize))
    }

    fn placed(&mut self, signature: &Signature, instructions: &Instructions) -> Option<*const u8> {
        let isa = &self.isa;
        let module = self.module.get_or_insert_with(|| {
            let builder = JITBuilder::with_isa(isa.clone(), default_libcall_names());
            Mutex::new(Memory(JITModule::new(builder)))
        });
        let module = &mut module.get_mut().ok()?.0;
        let function = module.declare_anonymous_function(signature).ok()?;
        let Instructions { bytes, alignment } = instructions;
        module
            .define_function_bytes(function, *alignment, bytes, &[])
            .ok()?;
        module.finalize_definitions().ok()?;
        Some(module.get_finalized_function(function))
    }

    /// Runs code from one of its blocks on: the number of the exit.
    #[inline]
    pub fn run(
        &mut self,
        entry: &Entry,
        _table: &[Entry],
        state: &mut NativeState,
        words: &mut [u32],
        marks: &[u8],
    ) -> Option<u32> {
        let enter = self.enter?;
        let (left, code) = (state.left, entry[1] as *const u8);
        let index = (entry[0] >> 48) as u32;
        // SAFETY: see the top of the file.
        Some(unsafe { enter(state, left, words.as_mut_ptr(), marks.as_ptr(), index, code) })
    }
}
