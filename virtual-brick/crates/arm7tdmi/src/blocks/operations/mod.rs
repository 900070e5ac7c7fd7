// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The operations that blocks are made of: one handler for each kind of instruction and operand.

/// Instances of a generic function, one for each value of its last constant argument.
macro_rules! instances {
    ($function:ident::<$($fixed:ident,)* [$($value:literal)*]>) => {
        instances!(@ $function [$($value)*] ($($fixed),*))
    };
    (@ $function:ident [$($value:literal)*] $fixed:tt) => {
        [$(instances!(@@ $function $value $fixed)),*]
    };
    (@@ $function:ident $value:literal ($($fixed:ident),*)) => {
        $function::<$($fixed,)* $value>
    };
}

pub(super) mod branch;
pub(super) mod data;
pub(super) mod encoding;
pub(super) mod run;
mod slow_path;
pub(super) mod status;
pub(super) mod transfer;
