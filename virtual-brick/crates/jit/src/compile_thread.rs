// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The compile thread: one for all engines of the process.
//!
//! It begins with the first request, serves one after the other and stays until the process ends.
//! A panic of the compiler continues where the result is taken. After a fork the child has no such
//! thread: its engines leave alone what they share with the parent's, and the first request of the
//! child begins another.

use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::sync::mpsc::{channel, Receiver, SendError, Sender};
use std::sync::{Arc, Mutex, TryLockError};
use std::{mem, process, thread};

use arm7tdmi::CompileAnswer;

use crate::code_memory::host_isa;
use crate::compiler::{CompileRequest, CompiledRegion, Compiler, Generation};

/// At most so many requests of an engine wait.
const QUEUE_MAX: usize = 32;

/// The thread of this process, once it has one.
static THREAD: Mutex<Option<CompileThread>> = Mutex::new(None);

/// The way to a compile thread.
#[derive(Clone)]
struct CompileThread {
    /// The process that has it.
    process: u32,
    requests: Sender<Request>,
}

struct Request {
    request: CompileRequest,
    wanted: Arc<Generation>,
    results: Sender<thread::Result<CompiledRegion>>,
}

impl CompileThread {
    /// A thread that serves requests with what `compiler` makes, anew after a panic. None where
    /// the host gives none.
    fn start<C: FnMut(&CompileRequest, &Generation) -> CompiledRegion>(
        compiler: impl Fn() -> C + Send + 'static,
    ) -> Option<Self> {
        let (requests, queue) = channel::<Request>();
        let thread = thread::Builder::new().name("JIT compiler".to_owned());
        let serve = move || {
            let mut made = None;
            for asked in queue {
                let result = catch_unwind(AssertUnwindSafe(|| {
                    made.get_or_insert_with(&compiler)(&asked.request, &asked.wanted)
                }));
                if result.is_err() {
                    made = None;
                }
                // The engine may be gone.
                let _ = asked.results.send(result);
            }
        };
        thread.spawn(serve).ok()?;
        let process = process::id();
        Some(Self { process, requests })
    }

    fn is_of_this_process(&self) -> bool {
        self.process == process::id()
    }

    /// That of the process; none where the host gives none. [`CompileAnswer::Busy`] while another
    /// engine begins it, and for ever in the child of a fork at such an instant.
    fn of_process() -> Result<Option<Self>, CompileAnswer> {
        let mut thread = match THREAD.try_lock() {
            Ok(thread) => thread,
            Err(TryLockError::Poisoned(thread)) => thread.into_inner(),
            Err(TryLockError::WouldBlock) => return Err(CompileAnswer::Busy),
        };
        if let Some(other) = thread.take_if(|thread| !thread.is_of_this_process()) {
            mem::forget(other);
        }
        if thread.is_none() {
            *thread = host_isa().and_then(|isa| {
                Self::start(move || {
                    let mut compiler = Compiler::new(isa.clone());
                    move |request: &_, wanted: &_| compiler.compile(request, wanted)
                })
            });
        }
        Ok(thread.clone())
    }
}

/// An engine's requests to the compile thread, and their results.
pub(crate) struct CompileQueue {
    wanted: Arc<Generation>,
    /// None before the first request.
    link: Option<Link>,
}

struct Link {
    thread: CompileThread,
    sender: Sender<thread::Result<CompiledRegion>>,
    /// The lock is never taken: it only makes the receiver shareable.
    results: Mutex<Receiver<thread::Result<CompiledRegion>>>,
    waiting: usize,
}

impl Link {
    fn to(thread: CompileThread) -> Self {
        let (sender, results) = channel();
        Self {
            thread,
            sender,
            results: Mutex::new(results),
            waiting: 0,
        }
    }
}

impl CompileQueue {
    pub fn new(wanted: Arc<Generation>) -> Self {
        Self { wanted, link: None }
    }

    /// The thread was that of the process before a fork: no more results will come.
    pub fn is_lost(&self) -> bool {
        let link = self.link.as_ref();
        link.is_some_and(|link| !link.thread.is_of_this_process())
    }

    /// Forgets a lost thread. What it shares with this process may be in any state.
    pub fn leave_lost(&mut self) {
        if self.is_lost() {
            mem::forget(self.link.take());
        }
    }

    /// The request comes back where there is no thread.
    pub fn submit(&mut self, request: CompileRequest) -> Result<CompileAnswer, CompileRequest> {
        let link = match &mut self.link {
            Some(link) => link,
            link => match CompileThread::of_process() {
                Ok(Some(thread)) => link.insert(Link::to(thread)),
                Ok(None) => return Err(request),
                Err(answer) => return Ok(answer),
            },
        };
        if link.waiting == QUEUE_MAX || !link.thread.is_of_this_process() {
            return Ok(CompileAnswer::Busy);
        }
        let asked = Request {
            request,
            wanted: Arc::clone(&self.wanted),
            results: link.sender.clone(),
        };
        let sent = link.thread.requests.send(asked);
        sent.map_err(|SendError(asked)| asked.request)?;
        link.waiting += 1;
        Ok(CompileAnswer::Queued)
    }

    /// The next result, if there is one by now. With `wait`, the call waits for it; none then
    /// means that nothing was requested.
    pub fn result(&mut self, wait: bool) -> Option<CompiledRegion> {
        let link = self.link.as_mut().filter(|link| link.waiting != 0)?;
        if !link.thread.is_of_this_process() {
            return None;
        }
        let results = link.results.get_mut().ok()?;
        let result = match wait {
            true => results.recv().ok()?,
            false => results.try_recv().ok()?,
        };
        link.waiting -= 1;
        Some(result.unwrap_or_else(|cause| resume_unwind(cause)))
    }
}

impl Drop for CompileQueue {
    fn drop(&mut self) {
        self.leave_lost();
        // Requests that wait are skipped.
        self.wanted.advance();
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use std::panic;
    use std::sync::mpsc::{sync_channel, SyncSender};

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

    fn queue_of(thread: &CompileThread) -> CompileQueue {
        CompileQueue {
            wanted: Arc::default(),
            link: Some(Link::to(thread.clone())),
        }
    }

    /// A thread that tells which request it serves, and does so when the sender lets it.
    fn gated() -> (CompileThread, SyncSender<()>, Receiver<u32>) {
        let (go, may_go) = sync_channel(64);
        let (started, starts) = sync_channel(64);
        let gate = Arc::new(Mutex::new(may_go));
        let thread = CompileThread::start(move || {
            let (started, gate) = (started.clone(), Arc::clone(&gate));
            move |request: &CompileRequest, _: &Generation| {
                let _ = started.send(request.region.number);
                let _ = gate.lock().unwrap().recv();
                CompiledRegion::without_code(request)
            }
        });
        (thread.unwrap(), go, starts)
    }

    fn number_of_next(queue: &mut CompileQueue) -> u32 {
        queue.result(true).unwrap().number
    }

    #[test]
    fn results_come_to_their_engine_in_the_order_of_its_requests() {
        let thread = CompileThread::start(|| {
            |request: &CompileRequest, _: &Generation| CompiledRegion::without_code(request)
        });
        let thread = thread.unwrap();
        let mut queues = [queue_of(&thread), queue_of(&thread)];
        for number in 0..QUEUE_MAX as u32 {
            let queue = &mut queues[number as usize % 2];
            assert!(matches!(
                queue.submit(request(0, number)),
                Ok(CompileAnswer::Queued)
            ));
        }
        for number in 0..QUEUE_MAX as u32 {
            assert_eq!(number_of_next(&mut queues[number as usize % 2]), number);
        }
        assert!(queues.iter_mut().all(|queue| queue.result(true).is_none()));
    }

    #[test]
    fn the_requests_of_an_engine_that_wait_are_bounded() {
        let (thread, go, starts) = gated();
        let (mut one, mut other) = (queue_of(&thread), queue_of(&thread));
        for number in 0..QUEUE_MAX as u32 {
            assert!(matches!(
                one.submit(request(0, number)),
                Ok(CompileAnswer::Queued)
            ));
        }
        assert!(matches!(
            one.submit(request(0, 99)),
            Ok(CompileAnswer::Busy)
        ));
        assert!(matches!(
            other.submit(request(0, 0)),
            Ok(CompileAnswer::Queued)
        ));
        assert_eq!(starts.recv(), Ok(0));
        drop(go);
        assert_eq!(number_of_next(&mut one), 0);
        assert!(matches!(
            one.submit(request(0, 99)),
            Ok(CompileAnswer::Queued)
        ));
    }

    #[test]
    fn requests_of_an_engine_that_is_gone_do_not_end_the_thread() {
        let (thread, go, starts) = gated();
        let (mut one, mut other) = (queue_of(&thread), queue_of(&thread));
        assert!(matches!(
            one.submit(request(0, 1)),
            Ok(CompileAnswer::Queued)
        ));
        assert!(matches!(
            other.submit(request(0, 2)),
            Ok(CompileAnswer::Queued)
        ));
        assert_eq!(starts.recv(), Ok(1));
        drop((one, go));
        assert_eq!(number_of_next(&mut other), 2);
    }

    #[test]
    fn a_panic_of_the_compiler_continues_where_its_result_is_taken() {
        let thread = CompileThread::start(|| {
            let mut served = 0;
            move |request: &CompileRequest, _: &Generation| {
                served += 1;
                assert!(request.region.number != 0, "no code for this");
                assert_eq!(served, 1, "the compiler of before the panic");
                CompiledRegion::without_code(request)
            }
        });
        let mut queue = queue_of(&thread.unwrap());
        assert!(matches!(
            queue.submit(request(0, 0)),
            Ok(CompileAnswer::Queued)
        ));
        assert!(matches!(
            queue.submit(request(0, 1)),
            Ok(CompileAnswer::Queued)
        ));
        let cause = panic::catch_unwind(AssertUnwindSafe(|| number_of_next(&mut queue)));
        assert_eq!(cause.unwrap_err().downcast_ref(), Some(&"no code for this"));
        assert_eq!(number_of_next(&mut queue), 1);
    }

    /// What a fork leaves to the child: a thread of another process.
    #[test]
    fn the_thread_of_another_process_is_left_alone() {
        let (mut thread, _go, starts) = gated();
        let mut queue = queue_of(&thread);
        assert!(matches!(
            queue.submit(request(0, 0)),
            Ok(CompileAnswer::Queued)
        ));
        assert_eq!(starts.recv(), Ok(0));
        thread.process = thread.process.wrapping_add(1);
        queue.link.as_mut().unwrap().thread.process = thread.process;
        assert!(queue.is_lost());
        assert!(matches!(
            queue.submit(request(0, 1)),
            Ok(CompileAnswer::Busy)
        ));
        assert!(queue.result(true).is_none());
        queue.leave_lost();
        assert!(!queue.is_lost() && queue.result(true).is_none());
    }
}
