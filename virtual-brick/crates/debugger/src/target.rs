// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The brick as a target of GDB: registers, memory, threads, breakpoints.

use std::convert::Infallible;

use gdbstub::common::Tid;
use gdbstub::target::ext::base::multithread::{MultiThreadBase, MultiThreadResumeOps};
use gdbstub::target::ext::base::single_register_access::{
    SingleRegisterAccess, SingleRegisterAccessOps,
};
use gdbstub::target::ext::base::BaseOps;
use gdbstub::target::ext::breakpoints::{
    Breakpoints, BreakpointsOps, HwBreakpoint, HwBreakpointOps, HwWatchpoint, HwWatchpointOps,
    SwBreakpoint, SwBreakpointOps, WatchKind,
};
use gdbstub::target::ext::flash::FlashOps;
use gdbstub::target::ext::memory_map::{MemoryMap, MemoryMapOps};
use gdbstub::target::ext::monitor_cmd::{ConsoleOutput, MonitorCmd, MonitorCmdOps};
use gdbstub::target::ext::thread_extra_info::{ThreadExtraInfo, ThreadExtraInfoOps};
use gdbstub::target::{Target, TargetError, TargetResult};
use gdbstub_arch::arm::ArmBreakpointKind;
use virtual_brick::VirtualBrick;

use crate::arch::{Brick, BrickRegister, BrickRegisters, MEMORY_MAP};
use crate::stops::Stops;
use crate::tasks::{self, Context};
use crate::timeline::{Change, Timeline};
use crate::watches::Watch;

// Parts of the protocol that extend `DebugTarget`, so each knows the other.
use crate::execution::Job;
use crate::monitor;

/// Longest range that may be watched.
const WATCH_BYTES_MAX: u32 = 4096;

/// A brick under the debugger.
#[derive(Debug)]
pub struct DebugTarget {
    pub(crate) timeline: Timeline,
    pub(crate) stops: Stops,
    pub(crate) job: Job,
    /// Breakpoints removed since the last stop: GDB takes them out to step over one of them.
    pub(crate) removed: Vec<u32>,
    /// Steps are those of one task; otherwise of the processor, interrupts included.
    pub(crate) steps_of_task: bool,
    /// The next step is the one at which a watchpoint was reported.
    pub(crate) at_watch: bool,
    /// The thread of the last stop.
    pub(crate) stopped: Tid,
    /// Bytes of the program's console that GDB has been shown.
    pub(crate) told: u64,
    /// Lines of the server's own for GDB's console.
    pub(crate) notices: String,
    /// Watched registers of which GDB has been told how far their watch goes.
    explained: Vec<u32>,
}

impl DebugTarget {
    /// The present of the brick becomes the beginning of its record.
    #[must_use]
    pub fn new(mut brick: VirtualBrick) -> Self {
        brick.set_semihosting(true);
        let stopped = Context::now(&brick).tid(&brick);
        Self {
            timeline: Timeline::new(brick),
            stops: Stops::default(),
            job: Job::Nothing,
            removed: Vec::new(),
            steps_of_task: true,
            at_watch: false,
            stopped,
            told: 0,
            notices: String::new(),
            explained: Vec::new(),
        }
    }

    /// The brick as the session left it.
    #[must_use]
    pub fn into_brick(self) -> VirtualBrick {
        self.timeline.into_brick()
    }

    /// Go to an instant, past or future: the first step that begins at or after it.
    pub fn run_to(&mut self, cycles: u64) {
        self.timeline.go_to(cycles);
        let brick = self.timeline.brick();
        self.stopped = Context::now(brick).tid(brick);
    }

    /// A new session begins: breakpoints of the last one are gone.
    pub(crate) fn begin_session(&mut self) {
        self.stops = Stops::default();
        self.removed.clear();
        self.explained.clear();
        self.job = Job::Nothing;
    }

    /// Answer a command of `monitor`.
    pub fn monitor(&mut self, line: &str) -> String {
        monitor::answer(self, line)
    }

    /// Output of the program since the last call, none on the run backwards; and what the
    /// server has to say.
    pub(crate) fn take_console(&mut self) -> Vec<u8> {
        let mut text = Vec::new();
        if !matches!(self.job, Job::Back(_)) {
            let brick = self.timeline.brick();
            text.extend(brick.console_since(self.told));
            self.told = brick.console_bytes();
        }
        text.extend(std::mem::take(&mut self.notices).into_bytes());
        text
    }

    /// GDB inserts a watchpoint at every resumption; the sentence comes once.
    fn explain(&mut self, watch: Watch) {
        let address = watch.address;
        let in_memory = watch.memory(self.timeline.brick()).is_some();
        if in_memory || watch.kind != WatchKind::Write || self.explained.contains(&address) {
            return;
        }
        self.explained.push(address);
        self.notices += &format!(
            "watch 0x{address:08x}: a register of a peripheral; stops (SIGUSR1) when the program \
             writes it, not when the hardware changes it; awatch stops at reads too\n"
        );
    }

    fn executes(&self, tid: Tid) -> bool {
        let brick = self.timeline.brick();
        Context::of(tid, brick) == Context::now(brick)
    }

    pub(crate) fn change(&mut self, change: Change) -> TargetResult<(), Self> {
        self.timeline
            .intervene(change)
            .map_err(|_| TargetError::NonFatal)
    }
}

impl Target for DebugTarget {
    type Arch = Brick;
    type Error = Infallible;

    fn base_ops(&mut self) -> BaseOps<'_, Self::Arch, Self::Error> {
        BaseOps::MultiThread(self)
    }

    fn support_breakpoints(&mut self) -> Option<BreakpointsOps<'_, Self>> {
        Some(self)
    }

    fn support_monitor_cmd(&mut self) -> Option<MonitorCmdOps<'_, Self>> {
        Some(self)
    }

    fn support_memory_map(&mut self) -> Option<MemoryMapOps<'_, Self>> {
        Some(self)
    }

    fn support_flash_operations(&mut self) -> Option<FlashOps<'_, Self>> {
        Some(self)
    }
}

impl MultiThreadBase for DebugTarget {
    fn read_registers(&mut self, regs: &mut BrickRegisters, tid: Tid) -> TargetResult<(), Self> {
        *regs = tasks::registers(tid, self.timeline.brick());
        Ok(())
    }

    fn write_registers(&mut self, regs: &BrickRegisters, tid: Tid) -> TargetResult<(), Self> {
        if !self.executes(tid) {
            return Err(TargetError::NonFatal);
        }
        let before = tasks::registers(tid, self.timeline.brick());
        // The status first: it decides which bank the others are in.
        for position in (0..regs.core.len()).rev() {
            if let Some(value) = regs.core[position].filter(|v| before.core[position] != Some(*v)) {
                let register = BrickRegister::Core(position);
                self.change(Change::Register { register, value })?;
            }
        }
        Ok(())
    }

    fn support_single_register_access(&mut self) -> Option<SingleRegisterAccessOps<'_, Tid, Self>> {
        Some(self)
    }

    fn read_addrs(&mut self, start: u32, data: &mut [u8], _tid: Tid) -> TargetResult<usize, Self> {
        let length = u32::try_from(data.len()).map_err(|_| TargetError::NonFatal)?;
        start.checked_add(length).ok_or(TargetError::NonFatal)?;
        let bytes = self
            .timeline
            .brick()
            .read_bus(start, data.len())
            .map_err(|_| TargetError::NonFatal)?;
        data.copy_from_slice(&bytes);
        Ok(data.len())
    }

    fn write_addrs(&mut self, start: u32, data: &[u8], _tid: Tid) -> TargetResult<(), Self> {
        self.change(Change::Memory {
            address: start,
            bytes: data.to_vec(),
        })
    }

    fn list_active_threads(&mut self, active: &mut dyn FnMut(Tid)) -> Result<(), Self::Error> {
        let mut threads = tasks::list(self.timeline.brick());
        // The first one is the one GDB takes when it means any.
        threads.sort_by_key(|tid| *tid != self.stopped);
        threads.into_iter().for_each(active);
        Ok(())
    }

    fn support_resume(&mut self) -> Option<MultiThreadResumeOps<'_, Self>> {
        Some(self)
    }

    fn support_thread_extra_info(&mut self) -> Option<ThreadExtraInfoOps<'_, Self>> {
        Some(self)
    }
}

impl SingleRegisterAccess<Tid> for DebugTarget {
    fn read_register(
        &mut self,
        tid: Tid,
        register: BrickRegister,
        buf: &mut [u8],
    ) -> TargetResult<usize, Self> {
        let registers = tasks::registers(tid, self.timeline.brick());
        let value = match register {
            BrickRegister::Core(position) => registers.core.get(position),
            BrickRegister::Banked(position) => registers.banked.get(position),
        };
        let value = value.copied().flatten().ok_or(TargetError::NonFatal)?;
        let bytes = value.to_le_bytes();
        buf.get_mut(..bytes.len())
            .ok_or(TargetError::NonFatal)?
            .copy_from_slice(&bytes);
        Ok(bytes.len())
    }

    fn write_register(
        &mut self,
        tid: Tid,
        register: BrickRegister,
        val: &[u8],
    ) -> TargetResult<(), Self> {
        let bytes = val.try_into().map_err(|_| TargetError::NonFatal)?;
        let value = u32::from_le_bytes(bytes);
        if matches!(register, BrickRegister::Core(_)) && !self.executes(tid) {
            return Err(TargetError::NonFatal);
        }
        self.change(Change::Register { register, value })
    }
}

impl ThreadExtraInfo for DebugTarget {
    fn thread_extra_info(&self, tid: Tid, buf: &mut [u8]) -> Result<usize, Self::Error> {
        let text = tasks::describe(tid, self.timeline.brick());
        let length = text.len().min(buf.len());
        buf[..length].copy_from_slice(&text.as_bytes()[..length]);
        Ok(length)
    }
}

impl Breakpoints for DebugTarget {
    fn support_sw_breakpoint(&mut self) -> Option<SwBreakpointOps<'_, Self>> {
        Some(self)
    }

    fn support_hw_breakpoint(&mut self) -> Option<HwBreakpointOps<'_, Self>> {
        Some(self)
    }

    fn support_hw_watchpoint(&mut self) -> Option<HwWatchpointOps<'_, Self>> {
        Some(self)
    }
}

impl SwBreakpoint for DebugTarget {
    fn add_sw_breakpoint(
        &mut self,
        addr: u32,
        _kind: ArmBreakpointKind,
    ) -> TargetResult<bool, Self> {
        self.stops.add_breakpoint(addr);
        Ok(true)
    }

    fn remove_sw_breakpoint(
        &mut self,
        addr: u32,
        _kind: ArmBreakpointKind,
    ) -> TargetResult<bool, Self> {
        let found = self.stops.remove_breakpoint(addr);
        if found {
            self.removed.push(addr);
        }
        Ok(found)
    }
}

impl HwBreakpoint for DebugTarget {
    fn add_hw_breakpoint(
        &mut self,
        addr: u32,
        kind: ArmBreakpointKind,
    ) -> TargetResult<bool, Self> {
        self.add_sw_breakpoint(addr, kind)
    }

    fn remove_hw_breakpoint(
        &mut self,
        addr: u32,
        kind: ArmBreakpointKind,
    ) -> TargetResult<bool, Self> {
        self.remove_sw_breakpoint(addr, kind)
    }
}

impl HwWatchpoint for DebugTarget {
    fn add_hw_watchpoint(
        &mut self,
        addr: u32,
        len: u32,
        kind: WatchKind,
    ) -> TargetResult<bool, Self> {
        if len == 0 || len > WATCH_BYTES_MAX {
            return Ok(false);
        }
        let watch = Watch {
            address: addr,
            length: len,
            kind,
        };
        self.explain(watch);
        self.stops.add_watch(watch);
        Ok(true)
    }

    fn remove_hw_watchpoint(
        &mut self,
        addr: u32,
        len: u32,
        kind: WatchKind,
    ) -> TargetResult<bool, Self> {
        Ok(self.stops.remove_watch(Watch {
            address: addr,
            length: len,
            kind,
        }))
    }
}

impl MemoryMap for DebugTarget {
    fn memory_map_xml(
        &self,
        offset: u64,
        length: usize,
        buf: &mut [u8],
    ) -> TargetResult<usize, Self> {
        let text = MEMORY_MAP.as_bytes();
        let start = usize::try_from(offset).map_or(text.len(), |at| at.min(text.len()));
        let rest = &text[start..];
        let length = rest.len().min(length).min(buf.len());
        buf[..length].copy_from_slice(&rest[..length]);
        Ok(length)
    }
}

impl MonitorCmd for DebugTarget {
    fn handle_monitor_cmd(
        &mut self,
        cmd: &[u8],
        mut out: ConsoleOutput<'_>,
    ) -> Result<(), Self::Error> {
        let answer = self.monitor(&String::from_utf8_lossy(cmd));
        out.write_raw(answer.as_bytes());
        Ok(())
    }
}
