// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The program's tasks as GDB's threads, with the registers of those that wait.
//!
//! Thread 1 is the processor outside all tasks: start-up, interrupt handlers, idle. Task `n` of
//! the run-time is thread `n + 2`. Where the contexts lie is told by the run-time's assembly
//! (`runtime/arm7tdmi`): a control block holds the stack pointer at offset 8; on that stack lies
//! the address to go on at, and above it, for a task that was preempted, status, r0-r3, r12, pc,
//! r4-r11 and lr. A task that waits of its own accord has its registers in the frame of the
//! subprogram that called the kernel: GDB finds them by the debug information, this module does
//! not know them. Nor does it know r4-r11 of a task while an interrupt handler runs.

use arm7tdmi::{psr, Mode};
use gdbstub::common::Tid;
use virtual_brick::{Thread, VirtualBrick};

use crate::arch::{Banked, BrickRegisters, BANKED, CPSR, PC};

const STACK_POINTER: u32 = 8;
const TERMINATED: u32 = 5;
/// Thread number of the task with index 0.
const FIRST_TASK: usize = 2;
/// The code that takes up a preempted task: mov r0, sp; add sp, sp, #28; ldmfd sp!, {r4-r11, lr}.
const TAKES_UP_PREEMPTED: [u32; 3] = [0xE1A0_000D, 0xE28D_D01C, 0xE8BD_4FF0];
/// Where a task goes on that waits in the run-time in Thumb state (`runtime/arm7tdmi/thumb`).
const SWITCHED: &str = "ravenbrick_switched";
const INTERRUPT_STACK_TOP: &str = "ravenbrick_interrupt_stack_top";
/// r0-r3, r12 and pc of the interrupted task.
const INTERRUPT_FRAME_BYTES: u32 = 24;
/// Status and thread below it.
const INTERRUPT_RECORD_BYTES: u32 = 8;
/// A task that waits goes on in System mode with interrupts masked.
const WAITING_STATUS: u32 = psr::I | psr::F | Mode::System.bits();

/// What executes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Context {
    /// No task: start-up, an interrupt handler, or idle.
    Processor,
    /// The task with the control block at this address.
    Task(u32),
}

impl Context {
    /// What executes now.
    pub(crate) fn now(brick: &VirtualBrick) -> Self {
        let in_task = matches!(brick.processor().mode(), Some(Mode::System | Mode::User));
        match brick.running_thread() {
            Some(block) if block != 0 && in_task => Self::Task(block),
            _ => Self::Processor,
        }
    }

    /// The thread number.
    pub(crate) fn tid(self, brick: &VirtualBrick) -> Tid {
        match self {
            Self::Processor => Tid::MIN,
            Self::Task(block) => {
                let index = brick.threads().iter().position(|t| t.address == block);
                index.map_or(Tid::MIN, tid_of)
            }
        }
    }

    /// The task with this thread number, else the processor.
    pub(crate) fn of(tid: Tid, brick: &VirtualBrick) -> Self {
        task(tid, brick).map_or(Self::Processor, |thread| Self::Task(thread.address))
    }
}

fn tid_of(index: usize) -> Tid {
    Tid::MIN.saturating_add(index.saturating_add(FIRST_TASK - 1))
}

fn task(tid: Tid, brick: &VirtualBrick) -> Option<Thread> {
    let index = tid.get().checked_sub(FIRST_TASK)?;
    brick.threads().into_iter().nth(index)
}

/// Thread numbers, who executes first; the processor only when it executes outside all tasks.
pub(crate) fn list(brick: &VirtualBrick) -> Vec<Tid> {
    let now = Context::now(brick).tid(brick);
    let tasks = brick.threads();
    let living = tasks.iter().enumerate();
    let others = living
        .filter(|(_, thread)| thread.state != TERMINATED)
        .map(|(index, _)| tid_of(index))
        .filter(|tid| *tid != now);
    std::iter::once(now).chain(others).collect()
}

/// Name, state and priority.
pub(crate) fn describe(tid: Tid, brick: &VirtualBrick) -> String {
    let Some(thread) = task(tid, brick) else {
        return processor_state(brick).to_owned();
    };
    let name = if thread.name.is_empty() {
        format!("task at {:#010X}", thread.address)
    } else {
        thread.name
    };
    let state = match thread.state {
        0 => "not started",
        1 if Context::now(brick) == Context::Task(thread.address) => "running",
        1 if brick.running_thread() == Some(thread.address) => "interrupted",
        1 => "ready",
        2 => "delayed",
        3 => "suspended",
        4 => "waiting at an entry",
        TERMINATED => "terminated",
        _ => "in an unknown state",
    };
    format!("{name}: {state}, priority {}", thread.base_priority)
}

fn processor_state(brick: &VirtualBrick) -> &'static str {
    match (brick.processor().mode(), brick.running_thread()) {
        (_, None) => "processor",
        (Some(Mode::Irq | Mode::Fiq), _) => "interrupt",
        _ if brick.threads().is_empty() => "start-up",
        (Some(Mode::Supervisor), _) => "interrupt handler",
        (Some(Mode::Abort | Mode::Undefined), _) => "exception",
        _ => "idle",
    }
}

/// Registers of a thread; none where they are not known.
pub(crate) fn registers(tid: Tid, brick: &VirtualBrick) -> BrickRegisters {
    let core = match Context::of(tid, brick) {
        who if who == Context::now(brick) => current_registers(brick),
        Context::Processor => [None; CPSR + 1],
        Context::Task(block) if brick.running_thread() == Some(block) => interrupted(brick),
        Context::Task(block) => waiting(brick, block).unwrap_or([None; CPSR + 1]),
    };
    BrickRegisters {
        core,
        banked: banked(brick),
    }
}

fn current_registers(brick: &VirtualBrick) -> [Option<u32>; CPSR + 1] {
    let cpu = brick.processor();
    let mut core = [Some(cpu.cpsr()); CPSR + 1];
    for (slot, value) in core.iter_mut().zip(cpu.registers()) {
        *slot = Some(value);
    }
    core
}

/// The banks of all modes.
fn banked(brick: &VirtualBrick) -> [Option<u32>; BANKED.len()] {
    let cpu = brick.processor();
    BANKED.map(|register| match register {
        Banked::Register(mode, number) => Some(cpu.banked_register(mode, number)),
        Banked::Status(mode) => cpu.spsr_of(mode),
    })
}

fn word(brick: &VirtualBrick, address: u32) -> Option<u32> {
    let bytes = brick.read_memory(address, 4).ok()?;
    bytes.try_into().ok().map(u32::from_le_bytes)
}

/// What the interrupt entry has saved of the running task, on the stack of IRQ mode.
fn interrupted(brick: &VirtualBrick) -> [Option<u32>; CPSR + 1] {
    let cpu = brick.processor();
    let mut core = [None; CPSR + 1];
    core[13] = Some(cpu.banked_register(Mode::System, 13));
    core[14] = Some(cpu.banked_register(Mode::System, 14));
    let Some(top) = brick.image().symbols().get(INTERRUPT_STACK_TOP) else {
        return core;
    };
    let depth = top.address.wrapping_sub(cpu.banked_register(Mode::Irq, 13));
    if depth == 0 && cpu.mode() == Some(Mode::Irq) {
        // At the vector: all registers are still those of the task.
        core[..13]
            .iter_mut()
            .zip(cpu.registers())
            .for_each(|(slot, value)| *slot = Some(value));
        core[PC] = Some(cpu.register(14).wrapping_sub(4));
        core[CPSR] = cpu.spsr();
        return core;
    }
    if (INTERRUPT_FRAME_BYTES + INTERRUPT_RECORD_BYTES..=0x1_0000).contains(&depth) {
        let frame = top.address - INTERRUPT_FRAME_BYTES;
        for (number, offset) in [(0, 0), (1, 4), (2, 8), (3, 12), (12, 16), (PC, 20)] {
            core[number] = word(brick, frame + offset);
        }
        core[CPSR] = word(brick, frame - INTERRUPT_RECORD_BYTES);
    }
    core
}

/// An ARM instruction of the image could lie here, or of a subprogram that the start of a flash
/// image copies to RAM: a context of another run-time is not one.
fn is_code(brick: &VirtualBrick, address: u32) -> bool {
    let image = brick.image();
    let function = image.symbols().function_at(address);
    let copied = function.is_some_and(|(_, function)| function.size > 0);
    let loaded = image.segments().iter().any(|segment| {
        let offset = address.wrapping_sub(segment.address) as usize;
        offset < segment.bytes.len()
    });
    address % 4 == 0 && (loaded || copied)
}

/// The context that the run-time in Thumb state leaves at `frame`: r4-r11 and the address at which
/// the caller of its switch goes on.
fn switched_out(brick: &VirtualBrick, frame: u32) -> Option<[Option<u32>; CPSR + 1]> {
    let mut core = [None; CPSR + 1];
    let mut address = frame;
    for register in [4, 5, 6, 7, 8, 9, 10, 11, 14] {
        core[register] = word(brick, address);
        address = address.wrapping_add(4);
    }
    let caller = core[14]?;
    let state = if caller & 1 == 0 { 0 } else { psr::T };
    core[13] = Some(address);
    core[PC] = Some(caller & !1);
    core[CPSR] = Some(Mode::System.bits() | state);
    Some(core)
}

/// The saved context of a task that does not run; none when there is none.
fn waiting(brick: &VirtualBrick, block: u32) -> Option<[Option<u32>; CPSR + 1]> {
    let top = word(brick, block.wrapping_add(STACK_POINTER))?;
    let goes_on_at = word(brick, top).filter(|address| is_code(brick, *address))?;
    let switched = brick.image().symbols().get(SWITCHED);
    if switched.is_some_and(|symbol| symbol.address == goes_on_at) {
        return switched_out(brick, top.wrapping_add(4));
    }
    let mut core = [None; CPSR + 1];
    let offsets = (0u32..).step_by(4);
    let preempted = TAKES_UP_PREEMPTED
        .iter()
        .zip(offsets)
        .all(|(code, offset)| word(brick, goes_on_at.wrapping_add(offset)) == Some(*code));
    if !preempted {
        core[13] = Some(top.wrapping_add(4));
        core[PC] = Some(goes_on_at);
        core[CPSR] = Some(WAITING_STATUS);
        return Some(core);
    }
    let order = [CPSR, 0, 1, 2, 3, 12, PC, 4, 5, 6, 7, 8, 9, 10, 11, 14];
    let mut address = top.wrapping_add(4);
    for register in order {
        core[register] = word(brick, address);
        address = address.wrapping_add(4);
    }
    core[13] = Some(address);
    Some(core)
}
