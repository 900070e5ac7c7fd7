// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Objects by name: address, size and scalar type.

use crate::error::ImageError;
use crate::scalar::ScalarKind;
use crate::symbols::{Symbol, Symbols};
use crate::{types, Elf};

/// A global object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Address.
    pub address: u32,
    /// Size in bytes, 0 when unknown.
    pub size: u32,
    /// Scalar type, when the debug information tells one.
    pub kind: Option<ScalarKind>,
}

/// Split `path` at dots: the longest prefix that is a symbol (as written, or the Ada form in
/// lower case joined by two underscores), then components by debug information.
pub(crate) fn resolve(
    file: Option<&Elf<'_>>,
    symbols: &Symbols,
    path: &str,
) -> Result<Variable, ImageError> {
    let parts: Vec<&str> = path.split('.').collect();
    for count in (1..=parts.len()).rev() {
        let (head, components) = parts.split_at(count);
        if let Some(symbol) = head_symbol(symbols, head) {
            return describe(file, symbol, components, path);
        }
    }
    Err(symbols.unknown(path, parts[parts.len() - 1]))
}

fn head_symbol(symbols: &Symbols, head: &[&str]) -> Option<Symbol> {
    symbols
        .get(&head.join("."))
        .or_else(|| symbols.get(&head.join("__").to_lowercase()))
}

fn describe(
    file: Option<&Elf<'_>>,
    symbol: Symbol,
    components: &[&str],
    path: &str,
) -> Result<Variable, ImageError> {
    let found = file.and_then(|file| types::scalar_at(file, symbol.address, components));
    match (found, components.is_empty()) {
        (Some(found), _) => Ok(Variable {
            address: symbol.address.wrapping_add(found.offset),
            size: found.size,
            kind: found.kind,
        }),
        (None, true) => Ok(Variable {
            address: symbol.address,
            size: symbol.size,
            kind: None,
        }),
        (None, false) => Err(ImageError::UnknownComponent {
            path: path.to_owned(),
            detail: format!(
                "the debug information has no component `{}` at {:#010X}",
                components.join("."),
                symbol.address
            ),
        }),
    }
}
