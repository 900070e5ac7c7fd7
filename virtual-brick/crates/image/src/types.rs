// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Types of global objects from the debug information (DWARF 5, sections 4.1 and 5).

use gimli::{AttributeValue, DebuggingInformationEntry, Dwarf, Operation, Unit, UnitOffset};

use crate::scalar::ScalarKind;
use crate::{debug_information, Elf, Reader};

type Entry<'a> = DebuggingInformationEntry<Reader<'a>>;

/// Typedefs and qualifiers in a row; a longer chain is taken for a loop.
const CHAIN_LENGTH_MAX: usize = 32;

/// An object or a component of one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Component {
    pub offset: u32,
    pub size: u32,
    pub kind: Option<ScalarKind>,
}

/// Type of the object at `address`, followed through `components`; none when the file has no
/// (or broken) debug information, or no such object or component.
pub(crate) fn scalar_at(file: &Elf<'_>, address: u32, components: &[&str]) -> Option<Component> {
    let dwarf = debug_information(file).ok()?;
    let mut headers = dwarf.units();
    while let Some(header) = headers.next().ok()? {
        let unit = dwarf.unit(header).ok()?;
        if let Some(start) = type_of_object(&unit, address) {
            return descend(&dwarf, &unit, start, components);
        }
    }
    None
}

fn type_of_object(unit: &Unit<Reader<'_>>, address: u32) -> Option<UnitOffset> {
    let mut entries = unit.entries();
    while let Some(entry) = entries.next_dfs().ok()? {
        if entry.tag() == gimli::DW_TAG_variable && location(unit, entry) == Some(address) {
            let direct = type_reference(entry);
            if direct.is_some() {
                return direct;
            }
            let declaration = reference(entry, gimli::DW_AT_specification)
                .or_else(|| reference(entry, gimli::DW_AT_abstract_origin))?;
            return type_reference(&unit.entry(declaration).ok()?);
        }
    }
    None
}

fn location(unit: &Unit<Reader<'_>>, entry: &Entry<'_>) -> Option<u32> {
    let AttributeValue::Exprloc(expression) = entry.attr_value(gimli::DW_AT_location)? else {
        return None;
    };
    match expression.operations(unit.encoding()).next().ok()?? {
        Operation::Address { address } => u32::try_from(address).ok(),
        _ => None,
    }
}

fn reference(entry: &Entry<'_>, name: gimli::DwAt) -> Option<UnitOffset> {
    match entry.attr_value(name)? {
        AttributeValue::UnitRef(offset) => Some(offset),
        _ => None,
    }
}

fn type_reference(entry: &Entry<'_>) -> Option<UnitOffset> {
    reference(entry, gimli::DW_AT_type)
}

fn number(entry: &Entry<'_>, name: gimli::DwAt) -> Option<u64> {
    entry.attr_value(name)?.udata_value()
}

fn descend(
    dwarf: &Dwarf<Reader<'_>>,
    unit: &Unit<Reader<'_>>,
    start: UnitOffset,
    components: &[&str],
) -> Option<Component> {
    let mut offset = 0u64;
    let mut kind_of = start;
    for component in components {
        let (step, next) = member(dwarf, unit, strip(unit, kind_of)?, component)?;
        offset += step;
        kind_of = next;
    }
    let (size, kind) = scalar(unit, strip(unit, kind_of)?)?;
    Some(Component {
        offset: u32::try_from(offset).ok()?,
        size: u32::try_from(size).ok()?,
        kind,
    })
}

/// Follow typedefs, qualifiers and subranges to the type that has a representation.
fn strip(unit: &Unit<Reader<'_>>, mut offset: UnitOffset) -> Option<UnitOffset> {
    for _ in 0..CHAIN_LENGTH_MAX {
        let entry = unit.entry(offset).ok()?;
        match entry.tag() {
            gimli::DW_TAG_typedef
            | gimli::DW_TAG_const_type
            | gimli::DW_TAG_volatile_type
            | gimli::DW_TAG_atomic_type => offset = type_reference(&entry)?,
            gimli::DW_TAG_subrange_type if !entry.has_attr(gimli::DW_AT_byte_size) => {
                offset = type_reference(&entry)?;
            }
            _ => return Some(offset),
        }
    }
    None
}

fn member(
    dwarf: &Dwarf<Reader<'_>>,
    unit: &Unit<Reader<'_>>,
    structure: UnitOffset,
    name: &str,
) -> Option<(u64, UnitOffset)> {
    let mut tree = unit.entries_tree(Some(structure)).ok()?;
    let mut children = tree.root().ok()?.children();
    while let Some(child) = children.next().ok()? {
        let entry = child.entry();
        if entry.tag() != gimli::DW_TAG_member {
            continue;
        }
        let Some(attribute) = entry.attr_value(gimli::DW_AT_name) else {
            continue;
        };
        let known = dwarf.attr_string(unit, attribute).ok()?;
        if known.to_string_lossy().eq_ignore_ascii_case(name) {
            let offset = number(entry, gimli::DW_AT_data_member_location).unwrap_or(0);
            return Some((offset, type_reference(entry)?));
        }
    }
    None
}

/// Size and, for a scalar, kind. A subrange takes the signedness of its base type.
fn scalar(unit: &Unit<Reader<'_>>, offset: UnitOffset) -> Option<(u64, Option<ScalarKind>)> {
    let entry = unit.entry(offset).ok()?;
    let size = number(&entry, gimli::DW_AT_byte_size).unwrap_or(4);
    let kind = match entry.tag() {
        gimli::DW_TAG_base_type => match entry.attr_value(gimli::DW_AT_encoding)? {
            AttributeValue::Encoding(encoding) => encoded(encoding, size),
            _ => None,
        },
        gimli::DW_TAG_enumeration_type | gimli::DW_TAG_pointer_type => {
            ScalarKind::integer(size, false)
        }
        gimli::DW_TAG_subrange_type => {
            let base = strip(unit, type_reference(&entry)?)?;
            let signed = scalar_encoding(unit, base) == Some(gimli::DW_ATE_signed);
            ScalarKind::integer(size, signed)
        }
        _ => None,
    };
    Some((size, kind))
}

fn scalar_encoding(unit: &Unit<Reader<'_>>, offset: UnitOffset) -> Option<gimli::DwAte> {
    match unit.entry(offset).ok()?.attr_value(gimli::DW_AT_encoding)? {
        AttributeValue::Encoding(encoding) => Some(encoding),
        _ => None,
    }
}

fn encoded(encoding: gimli::DwAte, size: u64) -> Option<ScalarKind> {
    match (encoding, size) {
        (gimli::DW_ATE_float, 4) => Some(ScalarKind::F32),
        (gimli::DW_ATE_float, 8) => Some(ScalarKind::F64),
        (gimli::DW_ATE_signed | gimli::DW_ATE_signed_char | gimli::DW_ATE_signed_fixed, _) => {
            ScalarKind::integer(size, true)
        }
        (
            gimli::DW_ATE_unsigned
            | gimli::DW_ATE_unsigned_char
            | gimli::DW_ATE_boolean
            | gimli::DW_ATE_unsigned_fixed,
            _,
        ) => ScalarKind::integer(size, false),
        _ => None,
    }
}
