// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The symbol table: by name, by address, and as a map of code and data.

use std::collections::BTreeMap;

use object::{Object, ObjectSymbol, SymbolKind};

use crate::error::ImageError;
use crate::Elf;

const SIMILAR_SHOWN: usize = 3;

/// A named address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Address; bit 0 is clear also for Thumb functions.
    pub address: u32,
    /// Size in bytes, 0 when the file does not say.
    pub size: u32,
}

/// A function, by all symbols of its address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Names in the order of the file, at least one.
    pub names: Vec<String>,
    /// Size in bytes, 0 when the file does not say.
    pub size: u32,
    /// It is Thumb code.
    pub thumb: bool,
}

/// Kind of the bytes after a mapping symbol (ELF for the Arm architecture, section 5.5.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Instructions in ARM state.
    Arm,
    /// Instructions in Thumb state.
    Thumb,
    /// Data.
    Data,
}

/// All named symbols of an image.
#[derive(Clone, Debug, Default)]
pub struct Symbols {
    by_name: BTreeMap<String, Symbol>,
    functions: BTreeMap<u32, Function>,
    objects: BTreeMap<u32, (u32, String)>,
    contents: BTreeMap<u32, Content>,
}

impl Symbols {
    pub(crate) fn read(file: &Elf<'_>) -> Self {
        let mut symbols = Self::default();
        let mut global_names: BTreeMap<String, bool> = BTreeMap::new();
        for symbol in file.symbols().filter(|symbol| !symbol.is_undefined()) {
            let Some(name) = symbol.name().ok().filter(|name| !name.is_empty()) else {
                continue;
            };
            let address = symbol.address() as u32;
            if let Some(content) = mapping_symbol(name) {
                symbols.contents.insert(address, content);
            }
            let kind = symbol.kind();
            if name.starts_with('$') || matches!(kind, SymbolKind::File | SymbolKind::Section) {
                continue;
            }
            let code = kind == SymbolKind::Text;
            let entry = Symbol {
                address: address & if code { !1 } else { !0 },
                size: symbol.size() as u32,
            };
            if code {
                symbols.add_function(name, address, entry.size);
            }
            if kind == SymbolKind::Data {
                let object = (entry.size, name.to_owned());
                symbols.objects.entry(address).or_insert(object);
            }
            let global = symbol.is_global();
            let known_global = global_names.get(name).copied();
            if known_global.is_none() || (global && known_global == Some(false)) {
                symbols.by_name.insert(name.to_owned(), entry);
                global_names.insert(name.to_owned(), global);
            }
        }
        symbols
    }

    fn add_function(&mut self, name: &str, address: u32, size: u32) {
        let function = self.functions.entry(address & !1).or_insert(Function {
            names: Vec::new(),
            size: 0,
            thumb: address & 1 != 0,
        });
        function.names.push(name.to_owned());
        function.size = function.size.max(size);
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

    /// All functions by their first address.
    #[must_use]
    pub fn functions(&self) -> &BTreeMap<u32, Function> {
        &self.functions
    }

    /// The function in which `address` lies, and its first address. A function without a size
    /// ends where the next one begins.
    #[must_use]
    pub fn function_at(&self, address: u32) -> Option<(u32, &Function)> {
        let (start, function) = self.functions.range(..=address).next_back()?;
        let inside = function.size == 0 || address - start < function.size;
        inside.then_some((*start, function))
    }

    /// The code symbol at or below `address` and the distance to it.
    #[must_use]
    pub fn nearest_code(&self, address: u32) -> Option<(&str, u32)> {
        let (start, function) = self.functions.range(..=address).next_back()?;
        Some((function.names.first()?, address - start))
    }

    /// The object of data in which `address` lies.
    #[must_use]
    pub fn object_at(&self, address: u32) -> Option<&str> {
        let (start, (size, name)) = self.objects.range(..=address).next_back()?;
        (address - start < *size).then_some(name)
    }

    /// Kind of the bytes at `address` and where they begin, by the last mapping symbol before.
    #[must_use]
    pub fn content_at(&self, address: u32) -> Option<(u32, Content)> {
        let (start, content) = self.contents.range(..=address).next_back()?;
        Some((*start, *content))
    }

    /// The error for `name`, with the symbols whose names contain `part`.
    pub(crate) fn unknown(&self, name: &str, part: &str) -> ImageError {
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

/// `$a`, `$t` or `$d`, alone or with a suffix after a dot.
fn mapping_symbol(name: &str) -> Option<Content> {
    let (kind, suffix) = name.split_at_checked(2)?;
    let content = match kind {
        "$a" => Content::Arm,
        "$t" => Content::Thumb,
        "$d" => Content::Data,
        _ => return None,
    };
    (suffix.is_empty() || suffix.starts_with('.')).then_some(content)
}
