// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The server over a real socket.
#![allow(clippy::unwrap_used)]

mod gdb;
#[path = "../../virtual-brick/tests/support/mod.rs"]
mod support;

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use debugger::{DebugTarget, Server, SessionEnd};
use gdb::packet;
use support::arm::{Program, ALWAYS};

fn target() -> DebugTarget {
    let mut program = Program::new();
    let again = program.here();
    program.add(0, 1).branch(ALWAYS, again);
    DebugTarget::new(support::brick(&program))
}

fn listen() -> Server {
    Server::listen(Ipv4Addr::LOCALHOST.into(), 0).unwrap()
}

/// Read until a packet that contains `part` has come.
fn wait_for(stream: &mut TcpStream, part: &str) -> String {
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .unwrap();
    let mut text = String::new();
    while !text.contains(part) {
        let mut buffer = [0; 256];
        let count = stream.read(&mut buffer).unwrap();
        assert!(count > 0, "the server closed after {text:?}");
        text.push_str(&String::from_utf8_lossy(&buffer[..count]));
    }
    text
}

#[test]
fn a_run_over_tcp_is_interrupted_and_a_second_session_may_follow() {
    let server = listen();
    let address = server.address();
    let client = thread::spawn(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&packet(b"?")).unwrap();
        wait_for(&mut stream, "T05");
        stream.write_all(&packet(b"vCont;c")).unwrap();
        thread::sleep(Duration::from_millis(50));
        stream.write_all(&[3]).unwrap();
        wait_for(&mut stream, "T02");
        stream.write_all(&packet(b"D")).unwrap();
        wait_for(&mut stream, "OK");
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&packet(b"?")).unwrap();
        wait_for(&mut stream, "T05");
        stream.write_all(&packet(b"k")).unwrap();
    });
    let mut target = target();
    let never = || false;
    let first = server.serve_one(&mut target, &never).unwrap();
    assert_eq!(first, Some(SessionEnd::Detached));
    let second = server.serve_one(&mut target, &never).unwrap();
    assert_eq!(second, Some(SessionEnd::Killed));
    client.join().unwrap();
    assert!(target.into_brick().cycles() > 100_000);
}

#[test]
fn the_caller_can_end_the_wait_and_a_session_under_way() {
    let server = listen();
    let address = server.address();
    let stop = AtomicBool::new(true);
    let wish = || stop.load(Ordering::Relaxed);
    assert_eq!(server.serve_one(&mut target(), &wish).unwrap(), None);
    stop.store(false, Ordering::Relaxed);
    let begin = Instant::now();
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(&packet(b"vCont;c")).unwrap();
            thread::sleep(Duration::from_millis(50));
            stop.store(true, Ordering::Relaxed);
            thread::sleep(Duration::from_millis(200));
        });
        let end = server.serve_one(&mut target(), &wish).unwrap();
        assert!(matches!(end, Some(SessionEnd::Broken(why)) if why.contains("told to stop")));
    });
    assert!(begin.elapsed() < Duration::from_secs(10));
}
