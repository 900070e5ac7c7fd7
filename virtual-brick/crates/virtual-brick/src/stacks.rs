// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Stacks that are too small: noticed when a watched word, such as the lowest of a stack, is
//! written or a large frame is taken; from then on the pointer is followed step by step, to the
//! byte. All engines notice it at the same instant: blocks are left for both.

use arm7tdmi::instruction::Operation;
use arm7tdmi::{psr, BlockBus, Instruction, Mode};

use crate::backtrace::{self, Call};
use crate::brick::VirtualBrick;
use crate::memory::ChipMemory;
use crate::threads::Memory;
use image::Image;

const STACK_POINTER: u32 = 13;
const RAM_BYTES: u32 = 0x1_0000;
/// RAM, and as much below it: the lowest stack is near its beginning.
const NEAR_RAM: std::ops::Range<u32> = 0x0020_0000 - RAM_BYTES..0x0020_0000 + RAM_BYTES;
/// As in [`arm7tdmi::DataProcessing::takes_large_frame`].
const LARGE_FRAME_BYTES: i32 = 128;
/// Where nothing tells the calls, they are looked for so often.
const BACKTRACES_MAX: u8 = 4;
const MISSING: &str = "ravenbrick_stack_missing";

/// Lowest address and size of a stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stack {
    pub base: u32,
    pub size: u32,
}

impl Stack {
    /// Bytes by which a stack pointer lies below; 0 inside, and far from any RAM.
    fn missing(self, pointer: u32) -> u32 {
        if NEAR_RAM.contains(&pointer) {
            self.base.saturating_sub(pointer)
        } else {
            0
        }
    }

    /// The stack of all interrupt handlers, of a program with our run-time.
    pub(crate) fn of_handlers(image: &Image) -> Option<Self> {
        let base = image.symbols().get("ravenbrick_handler_stack")?.address;
        let top = image.symbols().get("ravenbrick_handler_stack_top")?.address;
        Some(Self {
            base,
            size: top.checked_sub(base)?,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    Thread(usize),
    Handlers,
}

#[derive(Clone, Debug)]
struct Overflow {
    owner: Owner,
    missing: u32,
    /// How often the calls were looked for.
    backtraces: u8,
    calls: Vec<Call>,
}

/// Whose stack the stack pointer is in, and which stacks have overflowed.
#[derive(Clone, Debug)]
pub(crate) struct StackChecker {
    handlers: Option<Stack>,
    following: bool,
    owner: Option<usize>,
    running: Option<usize>,
    /// The thread whose stack pointer is loaded next.
    selected: Option<usize>,
    pointer: u32,
    overflows: Vec<Overflow>,
}

impl StackChecker {
    pub(crate) fn new(image: &Image) -> Self {
        Self {
            handlers: Stack::of_handlers(image),
            following: false,
            owner: None,
            running: None,
            selected: None,
            pointer: 0,
            overflows: Vec::new(),
        }
    }

    /// Each step is to be told.
    #[inline(always)]
    pub(crate) fn following(&self) -> bool {
        self.following
    }
}

impl VirtualBrick {
    /// A sentence for each stack that was too small, in the order of the first overflows.
    #[must_use]
    pub fn stack_overflows(&self) -> Vec<String> {
        let sentence = |overflow: &Overflow| {
            let now = self.missing_now(overflow.owner);
            self.overflow_sentence(overflow.owner, overflow.missing, now > 0, &overflow.calls)
        };
        self.stacks.overflows.iter().filter_map(sentence).collect()
    }

    /// The sentence for a stack check that failed in a thread, or in a handler.
    pub(crate) fn checked_overflow(&self, current: u32, calls: &[Call]) -> Option<String> {
        let symbol = self.image.symbols().get(MISSING)?;
        let missing = ChipMemory(&self.chip).word(symbol.address)?;
        let owner = self
            .recorder
            .thread_at(current)
            .map_or(Owner::Handlers, Owner::Thread);
        (missing > 0).then_some(())?;
        // The call that did not fit was not made, nor those that it would have made.
        self.overflow_sentence(owner, missing.min(RAM_BYTES), true, calls)
    }

    fn overflow_sentence(
        &self,
        owner: Owner,
        missing: u32,
        at_least: bool,
        calls: &[Call],
    ) -> Option<String> {
        let size = self.stack(owner)?.size;
        let least = if at_least { "at least " } else { "" };
        let place =
            backtrace::place(calls).map_or_else(String::new, |place| format!(" at {place}"));
        let wanted = size + missing;
        let option = |name| format!("link with -Wl,--defsym=ravenbrick_{name}_stack_size=BYTES");
        let (who, advice) = match owner {
            Owner::Handlers => (
                "a chain of interrupt handlers".to_owned(),
                option("handler"),
            ),
            Owner::Thread(index) => match self.recorder.name_of(index) {
                name if name == "environment" => (
                    backtrace::environment(calls),
                    format!("use a task, or {}", option("environment")),
                ),
                name => (
                    format!("task {name}"),
                    "give it a larger Storage_Size, and robot.toml the same stack_bytes".to_owned(),
                ),
            },
        };
        Some(format!(
            "stack overflow: {who} needs {least}{missing} bytes more than its stack of {size} \
             bytes has{place}; {advice} (more than {wanted})"
        ))
    }

    fn stack(&self, owner: Owner) -> Option<Stack> {
        match owner {
            Owner::Thread(index) => self.recorder.stack_of(index),
            Owner::Handlers => self.stacks.handlers,
        }
    }

    fn pointer_of(&self, owner: Owner) -> u32 {
        let mode = match owner {
            Owner::Thread(_) => Mode::System,
            Owner::Handlers => Mode::Supervisor,
        };
        self.cpu.banked_register(mode, STACK_POINTER)
    }

    fn missing_now(&self, owner: Owner) -> u32 {
        let mine = match owner {
            Owner::Thread(index) => self.recorder.running_index() == Some(index),
            Owner::Handlers => self.executes(owner),
        };
        let stack = self.stack(owner).filter(|_| mine);
        stack.map_or(0, |stack| stack.missing(self.pointer_of(owner)))
    }

    /// At a write of a watched word, a large frame or a fault. While threads are changed, in System
    /// mode with interrupts masked, the stack pointer may still be the other thread's.
    pub(crate) fn check_stacks(&mut self) {
        let alarm = self.recorder.take_stack_alarm();
        let changing = self.cpu.mode() == Some(Mode::System) && self.cpu.cpsr() & psr::I != 0;
        let running = self.recorder.running_index();
        let low = self.missing_now(Owner::Handlers) > 0
            || (!changing && running.is_some_and(|i| self.missing_now(Owner::Thread(i)) > 0));
        if !(alarm || low) {
            return;
        }
        self.stacks.following = true;
        self.stacks.running = running;
        self.stacks.owner = running;
        self.check_pointers();
    }

    /// After a step of the reference engine, which makes all those that take a large frame: from
    /// the instruction at `address`, with the stack pointer at `before`.
    #[inline(always)]
    pub(crate) fn check_stacks_after_step(&mut self, address: u32, before: u32) {
        if self.stacks.following {
            self.follow_stacks();
            return;
        }
        let taken = before.wrapping_sub(self.cpu.register(STACK_POINTER)) as i32;
        if taken >= LARGE_FRAME_BYTES && self.takes_large_frame(address) {
            self.check_stacks();
        }
    }

    /// What else moves a stack pointer as far, such as a change of threads, is no step of its own.
    #[cold]
    fn takes_large_frame(&self, address: u32) -> bool {
        if self.chip.code_place(address).is_none() {
            return false;
        }
        let word = self.chip.code_word(address & !3);
        let instruction = if self.cpu.thumb() {
            Instruction::thumb((word >> (8 * (address & 2))) as u16)
        } else {
            Instruction::arm(word)
        };
        match instruction.operation {
            Operation::DataProcessing(processing) => processing.takes_large_frame(),
            _ => false,
        }
    }

    #[cold]
    fn follow_stacks(&mut self) {
        let running = self.recorder.running_index();
        if running != self.stacks.running {
            self.stacks.running = running;
            self.stacks.selected = running;
        }
        let pointer = self.cpu.banked_register(Mode::System, STACK_POINTER);
        if pointer != self.stacks.pointer {
            self.stacks.pointer = pointer;
            if let Some(index) = self.stacks.selected.take() {
                self.stacks.owner = Some(index);
            }
        }
        self.check_pointers();
    }

    fn check_pointers(&mut self) {
        if let Some(index) = self.stacks.owner {
            self.check_stack(Owner::Thread(index));
        }
        if self.cpu.mode() == Some(Mode::Supervisor) {
            self.check_stack(Owner::Handlers);
        }
    }

    fn check_stack(&mut self, owner: Owner) {
        let stack = self.stack(owner);
        let missing = stack.map_or(0, |stack| stack.missing(self.pointer_of(owner)));
        if missing == 0 {
            return;
        }
        let known = &mut self.stacks.overflows;
        let number = known.iter().position(|known| known.owner == owner);
        let number = number.unwrap_or(known.len());
        if number == known.len() {
            known.push(Overflow {
                owner,
                missing,
                backtraces: 0,
                calls: Vec::new(),
            });
        }
        let overflow = &mut known[number];
        overflow.missing = overflow.missing.max(missing);
        let look = overflow.calls.is_empty() && overflow.backtraces < BACKTRACES_MAX;
        if look && self.executes(owner) {
            let calls = self.calls_from(self.cpu.registers());
            let overflow = &mut self.stacks.overflows[number];
            overflow.backtraces += 1;
            overflow.calls = calls;
        }
    }

    fn executes(&self, owner: Owner) -> bool {
        match owner {
            Owner::Thread(index) => {
                self.cpu.mode() == Some(Mode::System)
                    && self.recorder.running_index() == Some(index)
            }
            Owner::Handlers => self.cpu.mode() == Some(Mode::Supervisor),
        }
    }
}
