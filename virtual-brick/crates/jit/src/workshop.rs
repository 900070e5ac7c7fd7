// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A thread that makes code beside the run.
//!
//! It does one request after the other, and ends with its workshop, which waits for that: no more
//! threads are alive than workshops. A panic of the thread goes on where its answers are asked
//! for. After a fork the child has the memory of the workshop, but no thread; nothing of the
//! thread's is touched there.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{channel, sync_channel, Receiver, Sender, SyncSender, TryRecvError};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::{mem, panic, process};

use crate::compiler::{Made, Request};

/// Requests that wait at most.
const WAITING_MAX: usize = 32;

/// A thread at work, or what is left of one.
pub(crate) struct Workshop {
    /// The process that has the thread.
    process: u32,
    /// None once the thread has ended.
    thread: Option<Thread>,
}

struct Thread {
    requests: SyncSender<Request>,
    /// The lock is never taken: it only makes the receiver shareable.
    made: Mutex<Receiver<Made>>,
    /// Requests of this generation are worth their work.
    wanted: Arc<AtomicU32>,
    handle: JoinHandle<()>,
}

impl Workshop {
    /// With what makes code; none where the host gives no thread.
    pub fn open(make: impl FnMut(&Request) -> Made + Send + 'static) -> Option<Self> {
        let (requests, asked) = sync_channel(WAITING_MAX);
        let (answers, made) = channel();
        let wanted = Arc::new(AtomicU32::new(0));
        let current = Arc::clone(&wanted);
        let handle = thread::Builder::new()
            .name("native code".to_owned())
            .spawn(move || work(&asked, &answers, &current, make))
            .ok()?;
        Some(Self {
            process: process::id(),
            thread: Some(Thread {
                requests,
                made: Mutex::new(made),
                wanted,
                handle,
            }),
        })
    }

    /// The thread is gone, and what was asked for will not come.
    pub fn is_lost(&self) -> bool {
        self.thread.is_none() || self.process != process::id()
    }

    /// False if too much waits already.
    pub fn ask(&self, request: Request) -> bool {
        self.present().is_some_and(|thread| {
            thread.wanted.store(request.generation, Ordering::Relaxed);
            thread.requests.try_send(request).is_ok()
        })
    }

    /// What waits of other generations is worth no work.
    pub fn want_only(&self, generation: u32) {
        if let Some(thread) = self.present() {
            thread.wanted.store(generation, Ordering::Relaxed);
        }
    }

    /// The next answer, if there is one by now; else it is waited for on demand, for ever if
    /// nothing was asked for.
    pub fn answer(&mut self, waits: bool) -> Option<Made> {
        if self.is_lost() {
            return None;
        }
        let made = self.thread.as_mut()?.made.get_mut().ok()?;
        let answer = match waits {
            true => made.recv().map_err(|_| TryRecvError::Disconnected),
            false => made.try_recv(),
        };
        match answer {
            Ok(made) => return Some(made),
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {}
        }
        let thread = self.thread.take()?;
        if let Err(cause) = thread.handle.join() {
            panic::resume_unwind(cause);
        }
        None
    }

    fn present(&self) -> Option<&Thread> {
        self.thread.as_ref().filter(|_| !self.is_lost())
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        let lost = self.is_lost();
        let Some(thread) = self.thread.take() else {
            return;
        };
        if lost {
            mem::forget(thread);
            return;
        }
        thread.wanted.fetch_add(1, Ordering::Relaxed);
        drop((thread.requests, thread.made));
        // A panic that nobody will ask for has been reported by the thread.
        let _ = thread.handle.join();
    }
}

fn work(
    asked: &Receiver<Request>,
    answers: &Sender<Made>,
    wanted: &AtomicU32,
    mut make: impl FnMut(&Request) -> Made,
) {
    while let Ok(request) = asked.recv() {
        let wanted = request.generation == wanted.load(Ordering::Relaxed);
        if wanted && answers.send(make(&request)).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use std::sync::mpsc::{sync_channel, Receiver};

    use arm7tdmi::{NativeReach, NativeRegion};

    use super::*;
    use crate::region::Layout;

    fn request(generation: u32, number: u32) -> Request {
        Request {
            generation,
            region: NativeRegion {
                number,
                blocks: Vec::new(),
                reach: NativeReach {
                    first_halfword: 0,
                    mask: 0,
                    sequence_differs: false,
                },
                ram_cycles: 1,
            },
            layout: Layout {
                address: 0,
                words: 0,
                table: 0,
            },
        }
    }

    fn nothing_for(request: &Request) -> Made {
        Made {
            generation: request.generation,
            number: request.region.number,
            blocks: Vec::new(),
            exits: Vec::new(),
            instructions: None,
        }
    }

    /// A workshop that begins each request only when it is told to, by the sender.
    fn gated() -> (Workshop, SyncSender<()>, Receiver<u32>) {
        let (go, may_go) = sync_channel(64);
        let (begun, begins) = sync_channel(64);
        let workshop = Workshop::open(move |request: &Request| {
            let _ = begun.send(request.region.number);
            let _ = may_go.recv();
            nothing_for(request)
        });
        (workshop.unwrap(), go, begins)
    }

    fn wait_for_answer(workshop: &mut Workshop) -> Made {
        workshop.answer(true).unwrap()
    }

    #[test]
    fn answers_come_in_the_order_of_the_requests() {
        let mut workshop = Workshop::open(nothing_for).unwrap();
        for number in 0..WAITING_MAX as u32 {
            assert!(workshop.ask(request(0, number)));
        }
        for number in 0..WAITING_MAX as u32 {
            assert_eq!(wait_for_answer(&mut workshop).number, number);
        }
        assert!(workshop.answer(false).is_none());
    }

    #[test]
    fn what_waits_is_bounded() {
        let (workshop, go, begins) = gated();
        assert!(workshop.ask(request(0, 0)));
        assert_eq!(begins.recv(), Ok(0));
        for number in 1..=WAITING_MAX as u32 {
            assert!(workshop.ask(request(0, number)));
        }
        assert!(!workshop.ask(request(0, 99)));
        assert!(!workshop.is_lost());
        drop(go);
    }

    #[test]
    fn no_work_is_done_for_what_has_been_forgotten() {
        let (mut workshop, go, begins) = gated();
        for number in 0..3 {
            assert!(workshop.ask(request(0, number)));
        }
        assert_eq!(begins.recv(), Ok(0));
        workshop.want_only(1);
        assert!(workshop.ask(request(1, 3)));
        go.send(()).unwrap();
        go.send(()).unwrap();
        assert_eq!(begins.recv(), Ok(3));
        assert_eq!(wait_for_answer(&mut workshop).generation, 0);
        assert_eq!(wait_for_answer(&mut workshop).number, 3);
    }

    #[test]
    fn the_thread_has_ended_when_its_workshop_is_gone_and_leaves_what_waits() {
        let (workshop, go, begins) = gated();
        for number in 0..3 {
            assert!(workshop.ask(request(0, number)));
        }
        assert_eq!(begins.recv(), Ok(0));
        let wanted = Arc::clone(&workshop.present().unwrap().wanted);
        let leaving = thread::spawn(move || drop(workshop));
        while wanted.load(Ordering::Relaxed) == 0 {
            thread::yield_now();
        }
        drop(go);
        leaving.join().unwrap();
        // The thread has the only other end.
        assert!(begins.recv().is_err());
    }

    #[test]
    fn a_panic_of_the_thread_goes_on_where_its_answers_are_asked_for() {
        let mut workshop = Workshop::open(|_: &Request| panic!("no code for this")).unwrap();
        assert!(workshop.ask(request(0, 0)));
        let asked = panic::AssertUnwindSafe(|| wait_for_answer(&mut workshop).number);
        let cause = panic::catch_unwind(asked).unwrap_err();
        assert_eq!(cause.downcast_ref(), Some(&"no code for this"));
        assert!(workshop.is_lost());
        assert!(!workshop.ask(request(0, 1)));
        assert!(workshop.answer(true).is_none());
    }

    /// What a fork leaves to the child: a thread of another process.
    #[test]
    fn the_workshop_of_another_process_is_left_alone() {
        let (mut workshop, _go, begins) = gated();
        assert!(workshop.ask(request(0, 0)));
        assert_eq!(begins.recv(), Ok(0));
        workshop.process = workshop.process.wrapping_add(1);
        assert!(workshop.is_lost());
        assert!(!workshop.ask(request(0, 1)));
        assert!(workshop.answer(true).is_none());
        // It would not end: its thread waits.
        drop(workshop);
    }
}
