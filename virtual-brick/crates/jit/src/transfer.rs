// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Loads and stores of RAM whose words nobody watches.

use arm7tdmi::bus::Width;
use arm7tdmi::instruction::{Operand, Transfer};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{types, AliasRegion, InstBuilder, MemFlags, Value};

use crate::function::{Checked, Function};
use crate::reach::{alignment, distance, Reach};
use crate::table::AfterStore;

/// Accesses to RAM.
pub(crate) fn of_memory() -> MemFlags {
    MemFlags::trusted().with_alias_region(Some(AliasRegion::Heap))
}

/// RAM as the code knows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ram {
    pub address: u32,
    pub bytes: u32,
    pub cycles: u32,
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
    /// A load or store; false if it is not one that the code makes.
    pub fn transfer(
        &mut self,
        transfer: &Transfer,
        pc: u32,
        (literal, around): (Option<(u32, u32)>, Option<Reach>),
        ram: Ram,
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
            let Some(value) = self.loaded(transfer, access.place, around, ram) else {
                return false;
            };
            self.move_base(transfer, &access);
            self.set(transfer.register, value);
            return true;
        }
        if matches!(access.place, Place::Fixed(_)) {
            return false;
        }
        self.store(transfer, access.place, around, ram);
        self.move_base(transfer, &access);
        true
    }

    fn move_base(&mut self, transfer: &Transfer, access: &Access) {
        if let Some(moved) = access.moved {
            self.set(transfer.base, moved);
        }
    }

    /// The word that a load to r15 brings, and the base that goes with it, which is not yet moved.
    pub fn loaded_target(&mut self, transfer: &Transfer, pc: u32, ram: Ram) -> Option<Target> {
        let access = self.access(transfer, pc)?;
        let value = self.loaded(transfer, access.place, None, ram)?;
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
            (Some(offset), true) => self.builder.ins().iadd(base, offset),
            (Some(offset), false) => self.builder.ins().isub(base, offset),
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
                Place::At(self.builder.ins().iadd(pc, offset))
            }
            _ => return None,
        };
        Some(Access { place, moved: None })
    }

    /// Offset in RAM of an aligned access; leaves the code for others.
    fn ram_offset(&mut self, at: Value, width: Width, ram: Ram) -> Value {
        let start = self.constant(ram.address);
        let offset = self.builder.ins().isub(at, start);
        let outside = self.constant(!(ram.bytes - 1) | alignment(width));
        let odd = self.builder.ins().band(offset, outside);
        self.leave_if(odd);
        offset
    }

    /// What is known of the bytes that an access around a base reaches, with those behind it;
    /// leaves the code unless all are in RAM.
    fn checked(&mut self, base: Value, own: Reach, around: Option<Reach>, ram: Ram) -> usize {
        let covers = |checked: &Option<Checked>| {
            checked.is_some_and(|known| known.base == base && known.reach.covers(&own))
        };
        if let Some(found) = self.known.checked.iter().position(covers) {
            return found;
        }
        let reach = around.filter(|around| around.covers(&own)).unwrap_or(own);
        let first = self.constant((reach.first as u32).wrapping_sub(ram.address));
        let offset = self.builder.ins().iadd(base, first);
        // Bits that are not zero in a misaligned address come to the top.
        let bits = reach.alignment.count_ones();
        let units = if bits == 0 {
            offset
        } else {
            self.builder.ins().rotr_imm(offset, i64::from(bits))
        };
        let last = self.constant((ram.bytes - (reach.end - reach.first) as u32) >> bits);
        let above = IntCC::UnsignedGreaterThan;
        let outside = self.builder.ins().icmp(above, units, last);
        self.leave_if(outside);
        let start = self.behind(self.arguments.words, offset);
        self.known.checked.rotate_right(1);
        self.known.checked[0] = Some(Checked {
            base,
            reach,
            offset,
            start,
            mark: None,
        });
        0
    }

    /// Leaves the code if the word of an access is marked.
    fn leave_if_marked_around(&mut self, index: usize, distance: i32) {
        let Some(mut checked) = self.known.checked[index] else {
            return;
        };
        let behind = distance - checked.reach.first;
        let mark = if checked.reach.alignment == 3 {
            let start = checked.mark.unwrap_or_else(|| {
                let word = self.builder.ins().ushr_imm(checked.offset, 2);
                self.behind(self.arguments.marks, word)
            });
            checked.mark = Some(start);
            self.known.checked[index] = Some(checked);
            let ins = self.builder.ins();
            ins.load(types::I8, of_memory(), start, behind >> 2)
        } else {
            let behind = self.constant(behind as u32);
            let offset = self.builder.ins().iadd(checked.offset, behind);
            self.mark_at(offset)
        };
        self.leave_if(mark);
    }

    /// The mark of the word at an offset in RAM.
    fn mark_at(&mut self, offset: Value) -> Value {
        let word = self.builder.ins().ushr_imm(offset, 2);
        let mark = self.behind(self.arguments.marks, word);
        self.builder.ins().load(types::I8, of_memory(), mark, 0)
    }

    /// Address in the host's memory: so many bytes behind `start`.
    pub fn behind(&mut self, start: Value, offset: Value) -> Value {
        let offset = self.builder.ins().uextend(types::I64, offset);
        self.builder.ins().iadd(start, offset)
    }

    fn loaded(
        &mut self,
        transfer: &Transfer,
        place: Place,
        around: Option<Reach>,
        ram: Ram,
    ) -> Option<Value> {
        let words = self.arguments.words;
        let (start, offset) = match place {
            Place::Fixed(at) => {
                let offset = at.wrapping_sub(ram.address);
                if offset & (!(ram.bytes - 1) | alignment(transfer.width)) != 0 {
                    return None;
                }
                (words, offset as i32)
            }
            Place::At(at) => {
                let offset = self.ram_offset(at, transfer.width, ram);
                (self.behind(words, offset), 0)
            }
            Place::Around(base, distance) => {
                let own = Reach::of(distance, transfer.width);
                let index = self.checked(base, own, around, ram);
                let checked = self.known.checked[index]?;
                (checked.start, distance - checked.reach.first)
            }
        };
        self.known.pending += ram.cycles + 1;
        let (ins, flags) = (self.builder.ins(), of_memory());
        Some(match (transfer.width, transfer.signed) {
            (Width::Word, _) => ins.load(types::I32, flags, start, offset),
            (Width::Halfword, false) => ins.uload16(types::I32, flags, start, offset),
            (Width::Halfword, true) => ins.sload16(types::I32, flags, start, offset),
            (Width::Byte, false) => ins.uload8(types::I32, flags, start, offset),
            (Width::Byte, true) => ins.sload8(types::I32, flags, start, offset),
        })
    }

    fn store(&mut self, transfer: &Transfer, place: Place, around: Option<Reach>, ram: Ram) {
        let value = self.get(transfer.register);
        let (start, behind) = match place {
            Place::Fixed(_) => return,
            Place::At(at) => {
                let offset = self.ram_offset(at, transfer.width, ram);
                let mark = self.mark_at(offset);
                self.leave_if(mark);
                (self.behind(self.arguments.words, offset), 0)
            }
            Place::Around(base, distance) => {
                let own = Reach::of(distance, transfer.width);
                let index = self.checked(base, own, around, ram);
                self.leave_if_marked_around(index, distance);
                let Some(checked) = self.known.checked[index] else {
                    return;
                };
                (checked.start, distance - checked.reach.first)
            }
        };
        let (ins, flags) = (self.builder.ins(), of_memory());
        match transfer.width {
            Width::Word => ins.store(flags, value, start, behind),
            Width::Halfword => ins.istore16(flags, value, start, behind),
            Width::Byte => ins.istore8(flags, value, start, behind),
        };
        self.known.pending += ram.cycles;
        self.known.after_store = AfterStore::At(self.position.address);
    }
}

/// What a load to r15 brings.
pub(crate) struct Target {
    pub value: Value,
    pub moved: Option<Value>,
}

/// What a register receives.
const fn extended(transfer: &Transfer, value: u32) -> u32 {
    match (transfer.width, transfer.signed) {
        (Width::Byte, true) => value as u8 as i8 as u32,
        (Width::Halfword, true) => value as u16 as i16 as u32,
        _ => value,
    }
}
