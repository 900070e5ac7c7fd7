// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads, and stores to unmarked words of RAM.

use arm7tdmi::bus::Width;
use arm7tdmi::instruction::{Operand, Transfer};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, AliasRegion, InstBuilder, MemFlags, Value};

use crate::access_range::{alignment, distance, AccessRange};
use crate::entry_table::AfterStore;
use crate::function::{CheckedRange, Function};

/// Flags of accesses to RAM.
pub(crate) fn of_memory() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Heap))
}

/// Where an access goes.
#[derive(Clone, Copy)]
enum Place {
    Fixed(u32),
    At(Value),
    /// So far from a base.
    Around(Value, i32),
}

/// An access: its place and the moved base, if that is kept.
struct Access {
    place: Place,
    moved: Option<Value>,
}

impl Function<'_> {
    /// A load or store; false if the code cannot make it.
    pub fn transfer(
        &mut self,
        transfer: &Transfer,
        pc: u32,
        (literal, around): (Option<(u32, u32)>, Option<AccessRange>),
    ) -> bool {
        if transfer.register == 15 {
            return false;
        }
        if let (true, Some((value, cycles))) = (transfer.load, literal) {
            let value = self.constant(extended(transfer, value));
            self.set(transfer.register, value);
            self.known.pending += cycles + 1;
            return true;
        }
        let Some(access) = self.access(transfer, pc) else {
            return false;
        };
        if transfer.load {
            let Some(value) = self.loaded(transfer, access.place, around) else {
                return false;
            };
            self.move_base(transfer, &access);
            self.set(transfer.register, value);
            return true;
        }
        if matches!(access.place, Place::Fixed(_)) {
            return false;
        }
        self.store(transfer, access.place, around);
        self.move_base(transfer, &access);
        true
    }

    fn move_base(&mut self, transfer: &Transfer, access: &Access) {
        if let Some(moved) = access.moved {
            self.set(transfer.base, moved);
        }
    }

    /// The word that a load to r15 reads, and the new value of the base, which is not yet set.
    pub fn loaded_target(&mut self, transfer: &Transfer, pc: u32) -> Option<Target> {
        let access = self.access(transfer, pc)?;
        let value = self.loaded(transfer, access.place, None)?;
        Some(Target {
            value,
            moved: access.moved,
        })
    }

    fn access(&mut self, transfer: &Transfer, pc: u32) -> Option<Access> {
        let moves = transfer.moves_base();
        if transfer.base == 15 {
            return (!moves).then(|| self.relative(transfer, pc)).flatten();
        }
        let base = self.get(transfer.base);
        if let Some(distance) = distance(transfer) {
            return Some(Access {
                place: Place::Around(base, distance),
                moved: None,
            });
        }
        let offset = match transfer.offset {
            Operand::Constant { value: 0, .. } => None,
            Operand::Constant { value, .. } => Some(self.constant(value)),
            Operand::Shifted { register: 15, .. } | Operand::ShiftedByRegister { .. } => {
                return None
            }
            Operand::Shifted {
                register,
                kind,
                amount,
            } => {
                let value = self.get(register);
                Some(self.shifted(kind, value, amount).value)
            }
        };
        let moved = match (offset, transfer.add) {
            (None, _) => base,
            (Some(offset), true) => self.ins().iadd(base, offset),
            (Some(offset), false) => self.ins().isub(base, offset),
        };
        let used = if transfer.before { moved } else { base };
        Some(Access {
            place: Place::At(used),
            moved: moves.then_some(moved),
        })
    }

    /// Relative to r15.
    fn relative(&mut self, transfer: &Transfer, pc: u32) -> Option<Access> {
        let place = match transfer.offset {
            Operand::Constant { value, .. } if transfer.add => {
                Place::Fixed((pc & !3).wrapping_add(value))
            }
            Operand::Constant { value, .. } => Place::Fixed((pc & !3).wrapping_sub(value)),
            Operand::Shifted {
                register,
                kind: 0,
                amount,
            } if transfer.add && register != 15 => {
                let (pc, value) = (self.constant(pc & !3), self.get(register));
                let offset = self.shifted(0, value, amount).value;
                Place::At(self.ins().iadd(pc, offset))
            }
            _ => return None,
        };
        Some(Access { place, moved: None })
    }

    /// Offset in RAM of an aligned access; takes a side exit for any other.
    fn ram_offset(&mut self, at: Value, width: Width) -> Value {
        let start = self.constant(self.ram.address);
        let offset = self.ins().isub(at, start);
        let outside = self.constant(!(self.ram.bytes - 1) | alignment(width));
        let odd = self.ins().band(offset, outside);
        self.exit_if(odd);
        offset
    }

    /// Index of the known range that covers an access around a base and those behind it. Takes a
    /// side exit unless all bytes are in RAM.
    fn checked(&mut self, base: Value, own: AccessRange, around: Option<AccessRange>) -> usize {
        let covers = |checked: &Option<CheckedRange>| {
            checked.is_some_and(|known| known.base == base && known.range.covers(&own))
        };
        if let Some(found) = self.known.ranges.iter().position(covers) {
            return found;
        }
        let range = around.filter(|around| around.covers(&own)).unwrap_or(own);
        let first = self.constant((range.first as u32).wrapping_sub(self.ram.address));
        let offset = self.ins().iadd(base, first);
        // Bits that are not zero in a misaligned address come to the top.
        let bits = range.alignment.count_ones();
        let units = if bits == 0 {
            offset
        } else {
            self.ins().rotr_imm(offset, i64::from(bits))
        };
        let last = self.constant((self.ram.bytes - (range.end - range.first) as u32) >> bits);
        let above = IntCC::UnsignedGreaterThan;
        let outside = self.ins().icmp(above, units, last);
        self.exit_if(outside);
        let start = self.behind(self.arguments.words, offset);
        self.known.ranges.rotate_right(1);
        self.known.ranges[0] = Some(CheckedRange {
            base,
            range,
            offset,
            start,
            mark: None,
        });
        0
    }

    /// Takes a side exit if the word of an access is marked.
    fn exit_if_marked_around(&mut self, index: usize, distance: i32) {
        let Some(mut checked) = self.known.ranges[index] else {
            return;
        };
        let behind = distance - checked.range.first;
        let mark = if checked.range.alignment == 3 {
            let start = checked.mark.unwrap_or_else(|| {
                let word = self.ins().ushr_imm(checked.offset, 2);
                self.behind(self.arguments.marks, word)
            });
            checked.mark = Some(start);
            self.known.ranges[index] = Some(checked);
            let ins = self.ins();
            ins.load(types::I8, of_memory(), start, behind >> 2)
        } else {
            let behind = self.constant(behind as u32);
            let offset = self.ins().iadd(checked.offset, behind);
            self.mark_at(offset)
        };
        self.exit_if(mark);
    }

    /// The mark of the word at an offset in RAM.
    fn mark_at(&mut self, offset: Value) -> Value {
        let word = self.ins().ushr_imm(offset, 2);
        let mark = self.behind(self.arguments.marks, word);
        self.ins().load(types::I8, of_memory(), mark, 0)
    }

    /// Address in the host's memory: so many bytes behind `start`.
    pub fn behind(&mut self, start: Value, offset: Value) -> Value {
        let offset = self.ins().uextend(types::I64, offset);
        self.ins().iadd(start, offset)
    }

    fn loaded(
        &mut self,
        transfer: &Transfer,
        place: Place,
        around: Option<AccessRange>,
    ) -> Option<Value> {
        let words = self.arguments.words;
        let (start, offset) = match place {
            Place::Fixed(at) => {
                let offset = at.wrapping_sub(self.ram.address);
                if offset & (!(self.ram.bytes - 1) | alignment(transfer.width)) != 0 {
                    return None;
                }
                (words, offset as i32)
            }
            Place::At(at) => {
                let offset = self.ram_offset(at, transfer.width);
                (self.behind(words, offset), 0)
            }
            Place::Around(base, distance) => {
                let own = AccessRange::of(distance, transfer.width);
                let index = self.checked(base, own, around);
                let checked = self.known.ranges[index]?;
                (checked.start, distance - checked.range.first)
            }
        };
        self.known.pending += self.ram.cycles + 1;
        let (ins, flags) = (self.ins(), of_memory());
        Some(match (transfer.width, transfer.signed) {
            (Width::Word, _) => ins.load(types::I32, flags, start, offset),
            (Width::Halfword, false) => ins.uload16(types::I32, flags, start, offset),
            (Width::Halfword, true) => ins.sload16(types::I32, flags, start, offset),
            (Width::Byte, false) => ins.uload8(types::I32, flags, start, offset),
            (Width::Byte, true) => ins.sload8(types::I32, flags, start, offset),
        })
    }

    fn store(&mut self, transfer: &Transfer, place: Place, around: Option<AccessRange>) {
        let value = self.get(transfer.register);
        let (start, behind) = match place {
            Place::Fixed(_) => return,
            Place::At(at) => {
                let offset = self.ram_offset(at, transfer.width);
                let mark = self.mark_at(offset);
                self.exit_if(mark);
                (self.behind(self.arguments.words, offset), 0)
            }
            Place::Around(base, distance) => {
                let own = AccessRange::of(distance, transfer.width);
                let index = self.checked(base, own, around);
                self.exit_if_marked_around(index, distance);
                let Some(checked) = self.known.ranges[index] else {
                    return;
                };
                (checked.start, distance - checked.range.first)
            }
        };
        let (ins, flags) = (self.ins(), of_memory());
        match transfer.width {
            Width::Word => ins.store(flags, value, start, behind),
            Width::Halfword => ins.istore16(flags, value, start, behind),
            Width::Byte => ins.istore8(flags, value, start, behind),
        };
        self.known.pending += self.ram.cycles;
        self.known.after_store = AfterStore::At(self.position.address);
    }
}

/// The result of a load to r15.
pub(crate) struct Target {
    pub value: Value,
    pub moved: Option<Value>,
}

/// The value that a register receives.
const fn extended(transfer: &Transfer, value: u32) -> u32 {
    match (transfer.width, transfer.signed) {
        (Width::Byte, true) => value as u8 as i8 as u32,
        (Width::Halfword, true) => value as u16 as i16 as u32,
        _ => value,
    }
}
