// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Results of the divisions in the compiler's support library, by their definition in the run-time
//! ABI for the Arm architecture (section 4.3.1): the names are reserved for them.

use crate::inputs::image::{Entry, Image};
use crate::values::quotients::{divided, narrowed};
use crate::values::value::Value;

/// Quotient and, where the function gives one, remainder of a call with these arguments; nothing
/// unless the divisor is a constant above zero.
pub fn division(
    image: &Image,
    callees: &[Entry],
    arguments: (&Value, &Value),
) -> Option<(Value, Option<Value>)> {
    let [callee] = callees else {
        return None;
    };
    let divides = |name: &String| match name.as_str() {
        "__aeabi_uidiv" => Some((false, false)),
        "__aeabi_uidivmod" => Some((false, true)),
        "__aeabi_idiv" => Some((true, false)),
        "__aeabi_idivmod" => Some((true, true)),
        _ => None,
    };
    let (signed, both) = image.names_at(callee.0).iter().find_map(divides)?;
    let divisor = arguments.1.constant().filter(|d| *d > 0 && d >> 31 == 0)?;
    let (quotient, remainder) = divided(arguments.0, divisor, signed);
    Some((quotient, Some(remainder).filter(|_| both)))
}

/// Writes what is known of a division's results to r0 and r1.
pub fn apply_division(registers: &mut [Value; 15], results: (Value, Option<Value>)) {
    let (quotient, remainder) = results;
    registers[0] = narrowed(registers[0].clone(), Some(quotient));
    if let Some(remainder) = remainder {
        registers[1] = narrowed(registers[1].clone(), Some(remainder));
    }
}
