// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The symbol table: by name, and the nearest one below an address.

use std::collections::BTreeMap;

use object::{Object, ObjectSymbol, SymbolKind};

use super::error::ImageError;
use super::Elf;

const SIMILAR_SHOWN: usize = 3;

/// A named address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Address; bit 0 is clear also for Thumb functions.
    pub address: u32,
    /// Size in bytes, 0 when the file does not say.
    pub size: u32,
}

/// All named symbols of an image.
#[derive(Clone, Debug, Default)]
pub struct Symbols {
    by_name: BTreeMap<String, Symbol>,
    code_by_address: BTreeMap<u32, String>,
    objects_by_address: BTreeMap<u32, (u32, String)>,
}

impl Symbols {
    pub(super) fn read(file: &Elf<'_>) -> Self {
        let mut symbols = Self::default();
        let mut global_names: BTreeMap<String, bool> = BTreeMap::new();
        for symbol in file.symbols() {
            let named = symbol
                .name()
                .ok()
                .filter(|name| !name.is_empty() && !name.starts_with('$'));
            let Some(name) = named else { continue };
            let kind = symbol.kind();
            if symbol.is_undefined() || matches!(kind, SymbolKind::File | SymbolKind::Section) {
                continue;
            }
            let code = kind == SymbolKind::Text;
            let address = symbol.address() as u32 & if code { !1 } else { !0 };
            if code {
                symbols
                    .code_by_address
                    .entry(address)
                    .or_insert_with(|| name.to_owned());
            }
            if kind == SymbolKind::Data {
                let object = (symbol.size() as u32, name.to_owned());
                symbols.objects_by_address.entry(address).or_insert(object);
            }
            let global = symbol.is_global();
            let known_global = global_names.get(name).copied();
            if known_global.is_none() || (global && known_global == Some(false)) {
                let entry = Symbol {
                    address,
                    size: symbol.size() as u32,
                };
                symbols.by_name.insert(name.to_owned(), entry);
                global_names.insert(name.to_owned(), global);
            }
        }
        symbols
    }

    /// The symbol of this name; of several, the global one, else the first in the file.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Symbol> {
        self.by_name.get(name).copied()
    }

    /// The symbol of this name.
    ///
    /// # Errors
    /// There is none; the error shows names that contain it.
    pub fn find(&self, name: &str) -> Result<Symbol, ImageError> {
        self.get(name).ok_or_else(|| self.unknown(name, name))
    }

    /// All symbols in the order of names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Symbol)> {
        self.by_name
            .iter()
            .map(|(name, symbol)| (name.as_str(), *symbol))
    }

    /// The code symbol at or below `address` and the distance to it.
    #[must_use]
    pub fn nearest_code(&self, address: u32) -> Option<(&str, u32)> {
        let (start, name) = self.code_by_address.range(..=address).next_back()?;
        Some((name, address - start))
    }

    /// The object of data in which `address` lies.
    #[must_use]
    pub fn object_at(&self, address: u32) -> Option<&str> {
        let (start, (size, name)) = self.objects_by_address.range(..=address).next_back()?;
        (address - start < *size).then_some(name)
    }

    /// The error for `name`, with the symbols whose names contain `part`.
    pub(super) fn unknown(&self, name: &str, part: &str) -> ImageError {
        let wanted = part.to_lowercase();
        let similar = self
            .by_name
            .keys()
            .filter(|known| !wanted.is_empty() && known.to_lowercase().contains(&wanted))
            .take(SIMILAR_SHOWN)
            .cloned()
            .collect();
        ImageError::UnknownSymbol {
            name: name.to_owned(),
            similar,
        }
    }
}
