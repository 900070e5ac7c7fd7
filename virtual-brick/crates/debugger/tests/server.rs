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
use std::time::Duration;

use debugger::{DebugTarget, Server, SessionEnd};
use gdb::{expand, packet};
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
fn wait_for(stream: &mut TcpStream, part: &str) {
    wait_until(stream, |text| text.contains(part).then_some(()));
}

/// Read until what has come says something.
fn wait_until<T>(stream: &mut TcpStream, find: impl Fn(&str) -> Option<T>) -> T {
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let mut text = String::new();
    loop {
        if let Some(found) = find(&text) {
            return found;
        }
        let mut buffer = [0; 256];
        let count = stream.read(&mut buffer).unwrap();
        assert!(count > 0, "the server closed after {text:?}");
        text.push_str(&String::from_utf8_lossy(&buffer[..count]));
    }
}

/// The program's counter, r0, is no longer 0.
fn has_turned(stream: &mut TcpStream) -> bool {
    stream.write_all(&packet(b"g")).unwrap();
    wait_until(stream, |text| {
        let (registers, _) = text.rsplit_once('$')?.1.split_once('#')?;
        Some(!expand(registers).starts_with("00000000"))
    })
}

#[test]
fn a_run_over_tcp_is_interrupted_and_a_second_session_may_follow() {
    let server = listen();
    let address = server.address();
    let client = thread::spawn(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&packet(b"?")).unwrap();
        wait_for(&mut stream, "T05");
        // A slow server may find the wish to interrupt before its first turn.
        while !has_turned(&mut stream) {
            stream.write_all(&packet(b"vCont;c")).unwrap();
            thread::sleep(Duration::from_millis(50));
            stream.write_all(&[3]).unwrap();
            wait_for(&mut stream, "T02");
        }
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
    assert_ne!(target.into_brick().processor().register(0), 0);
}

#[test]
fn the_caller_can_end_the_wait_and_a_session_under_way() {
    let server = listen();
    let address = server.address();
    let stop = AtomicBool::new(true);
    let wish = || stop.load(Ordering::Relaxed);
    assert_eq!(server.serve_one(&mut target(), &wish).unwrap(), None);
    stop.store(false, Ordering::Relaxed);
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(&packet(b"vCont;c")).unwrap();
            thread::sleep(Duration::from_millis(50));
            stop.store(true, Ordering::Relaxed);
            // The session ends first.
            let _ = stream.read_to_end(&mut Vec::new());
        });
        let end = server.serve_one(&mut target(), &wish).unwrap();
        assert!(matches!(end, Some(SessionEnd::Broken(why)) if why.contains("told to stop")));
    });
}
