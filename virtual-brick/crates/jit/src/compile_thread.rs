// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The compile thread.
//!
//! It serves one request after the other and ends when its handle, [`CompileThread`], is dropped,
//! which waits for that: there are never more threads than handles. A panic of the thread continues
//! where its results are taken. After a fork the child has the memory of the handle, but no thread,
//! and touches nothing of the thread's.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{channel, sync_channel, Receiver, Sender, SyncSender, TryRecvError};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::{mem, panic, process};

use crate::compiler::{CompileRequest, CompiledRegion};

/// At most so many requests wait.
const QUEUE_MAX: usize = 32;

/// The handle of a compile thread.
pub(crate) struct CompileThread {
    /// The process that has the thread.
    process: u32,
    /// None once the thread has ended.
    thread: Option<Thread>,
}

struct Thread {
    requests: SyncSender<CompileRequest>,
    /// The lock is never taken: it only makes the receiver shareable.
    results: Mutex<Receiver<CompiledRegion>>,
    /// Requests of other generations are skipped.
    generation: Arc<AtomicU32>,
    handle: JoinHandle<()>,
}

impl CompileThread {
    /// None where the host gives no thread.
    pub fn start(
        compile: impl FnMut(&CompileRequest) -> CompiledRegion + Send + 'static,
    ) -> Option<Self> {
        let (requests, queue) = sync_channel(QUEUE_MAX);
        let (sender, results) = channel();
        let generation = Arc::new(AtomicU32::new(0));
        let current = Arc::clone(&generation);
        let handle = thread::Builder::new()
            .name("JIT compiler".to_owned())
            .spawn(move || serve(&queue, &sender, &current, compile))
            .ok()?;
        Some(Self {
            process: process::id(),
            thread: Some(Thread {
                requests,
                results: Mutex::new(results),
                generation,
                handle,
            }),
        })
    }

    /// The thread is gone, and no more results will come.
    pub fn is_lost(&self) -> bool {
        self.thread.is_none() || self.process != process::id()
    }

    /// False if too many requests wait already.
    pub fn submit(&self, request: CompileRequest) -> bool {
        self.alive().is_some_and(|thread| {
            thread
                .generation
                .store(request.generation, Ordering::Relaxed);
            thread.requests.try_send(request).is_ok()
        })
    }

    /// Requests of other generations are skipped from now on.
    pub fn set_generation(&self, generation: u32) {
        if let Some(thread) = self.alive() {
            thread.generation.store(generation, Ordering::Relaxed);
        }
    }

    /// The next result, if there is one by now. With `wait`, the call waits for it, for ever if
    /// nothing was requested.
    pub fn result(&mut self, wait: bool) -> Option<CompiledRegion> {
        if self.is_lost() {
            return None;
        }
        let results = self.thread.as_mut()?.results.get_mut().ok()?;
        let result = match wait {
            true => results.recv().map_err(|_| TryRecvError::Disconnected),
            false => results.try_recv(),
        };
        match result {
            Ok(compiled) => return Some(compiled),
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {}
        }
        let thread = self.thread.take()?;
        if let Err(cause) = thread.handle.join() {
            panic::resume_unwind(cause);
        }
        None
    }

    fn alive(&self) -> Option<&Thread> {
        self.thread.as_ref().filter(|_| !self.is_lost())
    }
}

impl Drop for CompileThread {
    fn drop(&mut self) {
        let lost = self.is_lost();
        let Some(thread) = self.thread.take() else {
            return;
        };
        if lost {
            mem::forget(thread);
            return;
        }
        thread.generation.fetch_add(1, Ordering::Relaxed);
        drop((thread.requests, thread.results));
        // The thread has reported a panic that nobody will see here.
        let _ = thread.handle.join();
    }
}

fn serve(
    queue: &Receiver<CompileRequest>,
    results: &Sender<CompiledRegion>,
    generation: &AtomicU32,
    mut compile: impl FnMut(&CompileRequest) -> CompiledRegion,
) {
    while let Ok(request) = queue.recv() {
        let valid = request.generation == generation.load(Ordering::Relaxed);
        if valid && results.send(compile(&request)).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use std::sync::mpsc::{sync_channel, Receiver};

    use arm7tdmi::{CodeWindow, Region};

    use super::*;
    use crate::region::Layout;

    fn request(generation: u32, number: u32) -> CompileRequest {
        CompileRequest {
            generation,
            region: Region {
                number,
                blocks: Vec::new(),
                window: CodeWindow {
                    first_halfword: 0,
                    mask: 0,
                    sequence_differs: false,
                },
                ram_cycles: 1,
            },
            layout: Layout {
                ram_address: 0,
                ram_words: 0,
                table_address: 0,
            },
        }
    }

    fn no_code_for(request: &CompileRequest) -> CompiledRegion {
        CompiledRegion {
            generation: request.generation,
            number: request.region.number,
            blocks: Vec::new(),
            exits: Vec::new(),
            code: None,
        }
    }

    /// A thread that tells which request it starts, and serves it when the sender lets it.
    fn gated() -> (CompileThread, SyncSender<()>, Receiver<u32>) {
        let (go, may_go) = sync_channel(64);
        let (started, starts) = sync_channel(64);
        let compile_thread = CompileThread::start(move |request: &CompileRequest| {
            let _ = started.send(request.region.number);
            let _ = may_go.recv();
            no_code_for(request)
        });
        (compile_thread.unwrap(), go, starts)
    }

    fn wait_for_result(thread: &mut CompileThread) -> CompiledRegion {
        thread.result(true).unwrap()
    }

    #[test]
    fn results_come_in_the_order_of_the_requests() {
        let mut compile_thread = CompileThread::start(no_code_for).unwrap();
        for number in 0..QUEUE_MAX as u32 {
            assert!(compile_thread.submit(request(0, number)));
        }
        for number in 0..QUEUE_MAX as u32 {
            assert_eq!(wait_for_result(&mut compile_thread).number, number);
        }
        assert!(compile_thread.result(false).is_none());
    }

    #[test]
    fn the_queue_is_bounded() {
        let (compile_thread, go, starts) = gated();
        assert!(compile_thread.submit(request(0, 0)));
        assert_eq!(starts.recv(), Ok(0));
        for number in 1..=QUEUE_MAX as u32 {
            assert!(compile_thread.submit(request(0, number)));
        }
        assert!(!compile_thread.submit(request(0, 99)));
        assert!(!compile_thread.is_lost());
        drop(go);
    }

    #[test]
    fn requests_of_an_invalid_generation_are_skipped() {
        let (mut compile_thread, go, starts) = gated();
        for number in 0..3 {
            assert!(compile_thread.submit(request(0, number)));
        }
        assert_eq!(starts.recv(), Ok(0));
        compile_thread.set_generation(1);
        assert!(compile_thread.submit(request(1, 3)));
        go.send(()).unwrap();
        go.send(()).unwrap();
        assert_eq!(starts.recv(), Ok(3));
        assert_eq!(wait_for_result(&mut compile_thread).generation, 0);
        assert_eq!(wait_for_result(&mut compile_thread).number, 3);
    }

    #[test]
    fn dropping_the_handle_ends_the_thread_and_skips_waiting_requests() {
        let (compile_thread, go, starts) = gated();
        for number in 0..3 {
            assert!(compile_thread.submit(request(0, number)));
        }
        assert_eq!(starts.recv(), Ok(0));
        let generation = Arc::clone(&compile_thread.alive().unwrap().generation);
        let dropping = thread::spawn(move || drop(compile_thread));
        while generation.load(Ordering::Relaxed) == 0 {
            thread::yield_now();
        }
        drop(go);
        dropping.join().unwrap();
        // The thread has the only other end.
        assert!(starts.recv().is_err());
    }

    #[test]
    fn a_panic_of_the_thread_continues_where_its_results_are_taken() {
        let mut compile_thread =
            CompileThread::start(|_: &CompileRequest| panic!("no code for this")).unwrap();
        assert!(compile_thread.submit(request(0, 0)));
        let taking = panic::AssertUnwindSafe(|| wait_for_result(&mut compile_thread).number);
        let cause = panic::catch_unwind(taking).unwrap_err();
        assert_eq!(cause.downcast_ref(), Some(&"no code for this"));
        assert!(compile_thread.is_lost());
        assert!(!compile_thread.submit(request(0, 1)));
        assert!(compile_thread.result(true).is_none());
    }

    /// What a fork leaves to the child: a thread of another process.
    #[test]
    fn the_thread_of_another_process_is_left_alone() {
        let (mut compile_thread, _go, starts) = gated();
        assert!(compile_thread.submit(request(0, 0)));
        assert_eq!(starts.recv(), Ok(0));
        compile_thread.process = compile_thread.process.wrapping_add(1);
        assert!(compile_thread.is_lost());
        assert!(!compile_thread.submit(request(0, 1)));
        assert!(compile_thread.result(true).is_none());
        // It would not end: its thread waits.
        drop(compile_thread);
    }
}
