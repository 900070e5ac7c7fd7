// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Compiled functions and their signatures.

use cranelift_codegen::ir::{types, AbiParam, Signature};
use cranelift_codegen::isa::{CallConv, OwnedTargetIsa};

/// Machine code of a function, independent of its address.
pub(crate) struct HostCode {
    pub bytes: Vec<u8>,
    pub alignment: u64,
}

/// Signature of a region's code. Parameters: state, cycles left, words, marks, index of the block
/// to begin with. Results: cycles left, number of the exit.
pub(crate) fn region_signature() -> Signature {
    let mut signature = Signature::new(CallConv::Tail);
    let parameters = [types::I64, types::I32, types::I64, types::I64, types::I32];
    signature.params.extend(parameters.map(AbiParam::new));
    signature.returns = vec![AbiParam::new(types::I32), AbiParam::new(types::I32)];
    signature
}

/// Signature of the function through which regions are entered from Rust: the parameters of a
/// region and the address of its code. Result: number of the exit.
pub(crate) fn entry_signature(isa: &OwnedTargetIsa) -> Signature {
    let mut signature = Signature::new(isa.default_call_conv());
    signature.params = region_signature().params;
    signature.params.push(AbiParam::new(types::I64));
    signature.returns = vec![AbiParam::new(types::I32)];
    signature
}
