// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The server over a real socket.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::gdb::packet;
use crate::support::arm::{Program, ALWAYS};
use debugger::{DebugTarget, Server, SessionEnd};

const TEXT: u32 = 0x0020_8000;
const CALL: u32 = 0xEF12_3456;
/// What the protocol makes of the text.
const SAID: &str = "O68690a";

/// For ever: counts in r2, and says so.
fn target() -> DebugTarget {
    let mut program = Program::new();
    program.load(1, TEXT);
    let again = program.here();
    program.add(2, 1).load(0, 4).raw(CALL);
    program.delay(100_000).branch(ALWAYS, again);
    let mut brick = crate::support::brick(&program);
    brick.write_memory(TEXT, b"hi\n\0").unwrap();
    DebugTarget::new(brick)
}

fn listen() -> Server {
    Server::listen(Ipv4Addr::LOCALHOST.into(), 0).unwrap()
}

/// Read until a packet that contains `part` has come, to its end: a connection that is closed with
/// something unread in it is reset.
fn wait_for(stream: &mut TcpStream, part: &str) {
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let mut text = String::new();
    while !has_packet(&text, part) {
        let mut buffer = [0; 256];
        let count = stream.read(&mut buffer).unwrap();
        assert!(count > 0, "the server closed after {text:?}");
        text.push_str(&String::from_utf8_lossy(&buffer[..count]));
    }
}

/// Whether a packet that contains `part` is there with its sum of two digits.
fn has_packet(text: &str, part: &str) -> bool {
    let sum = text
        .split_once(part)
        .and_then(|(_, rest)| rest.split_once('#'));
    sum.is_some_and(|(_, digits)| digits.len() >= 2)
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
        wait_for(&mut stream, SAID);
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
    assert_ne!(target.into_brick().processor().register(2), 0);
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
            wait_for(&mut stream, SAID);
            stop.store(true, Ordering::Relaxed);
            // The session ends first.
            let _ = stream.read_to_end(&mut Vec::new());
        });
        let end = server.serve_one(&mut target(), &wish).unwrap();
        assert!(matches!(end, Some(SessionEnd::Broken(why)) if why.contains("told to stop")));
    });
}

#[test]
fn a_packet_in_the_request_of_a_browser_is_not_read() {
    let server = listen();
    let address = server.address();
    let post = thread::spawn(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        let mut request = b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".to_vec();
        request.extend(packet(format!("M{TEXT:x},1:00").as_bytes()));
        stream.write_all(&request).unwrap();
        // The session ends first.
        let _ = stream.read_to_end(&mut Vec::new());
    });
    let mut target = target();
    let end = server.serve_one(&mut target, &|| false).unwrap();
    assert!(matches!(end, Some(SessionEnd::Broken(why)) if why.contains("no GDB")));
    post.join().unwrap();
    assert_eq!(target.into_brick().read_memory(TEXT, 1).unwrap(), b"h");
}
