// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The server: one GDB at a time over TCP.

use std::convert::Infallible;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use gdbstub::conn::{Connection, ConnectionExt};
use gdbstub::stub::run_blocking::{BlockingEventLoop, Event, WaitForStopReasonError};
use gdbstub::stub::{DisconnectReason, GdbStub, MultiThreadStopReason};

use crate::target::DebugTarget;

/// How long a look at the caller's wish to stop may be late.
const PATIENCE: Duration = Duration::from_millis(50);
/// What GDB begins with: an acknowledgement, a packet, or an interruption. Any site can have a
/// browser send a request with packets in it to this port.
const FIRST_BYTES: &[u8] = b"+-$\x03";
/// GDB takes packets of a few hundred bytes at least.
const CONSOLE_PIECE_BYTES: usize = 128;

/// How a session ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionEnd {
    /// GDB detached; another session may follow.
    Detached,
    /// GDB ended the program.
    Killed,
    /// The connection broke, or what came over it was no GDB protocol; with the reason.
    Broken(String),
}

/// A server that listens and has not yet accepted anybody.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
}

impl Server {
    /// Listen at an address; port 0 takes a free one.
    ///
    /// # Errors
    /// The address cannot be used.
    pub fn listen(address: IpAddr, port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((address, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serve the next GDB that connects. None when `stop` became true while nobody was there;
    /// a session under way ends as broken then.
    ///
    /// # Errors
    /// Nobody can be accepted any more.
    pub fn serve_one(
        &self,
        target: &mut DebugTarget,
        stop: &dyn Fn() -> bool,
    ) -> io::Result<Option<SessionEnd>> {
        loop {
            match self.listener.accept() {
                Ok((stream, _)) => {
                    let session = Link::new(stream, stop).map(|link| session(target, link));
                    return Ok(Some(session.unwrap_or_else(broken)));
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if stop() {
                        return Ok(None);
                    }
                    std::thread::sleep(PATIENCE);
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Serve one GDB after the other until one ends the program or `stop` becomes true.
    ///
    /// # Errors
    /// Nobody can be accepted any more.
    pub fn serve(&self, target: &mut DebugTarget, stop: &dyn Fn() -> bool) -> io::Result<()> {
        while let Some(end) = self.serve_one(target, stop)? {
            if end == SessionEnd::Killed || stop() {
                break;
            }
        }
        Ok(())
    }
}

fn broken(error: impl ToString) -> SessionEnd {
    SessionEnd::Broken(error.to_string())
}

/// One session over any connection.
pub fn session<C>(target: &mut DebugTarget, connection: C) -> SessionEnd
where
    C: ConnectionExt,
    C::Error: std::fmt::Display + std::fmt::Debug,
{
    target.begin_session();
    match GdbStub::new(connection).run_blocking::<EventLoop<C>>(target) {
        Ok(DisconnectReason::Disconnect) => SessionEnd::Detached,
        Ok(_) => SessionEnd::Killed,
        Err(error) => broken(error),
    }
}

/// Let GDB show the output of the program: packets `O` with hexadecimal digits, which may come at
/// any time while the program runs (GDB manual, "Stop Reply Packets").
fn send_console_output<C: Connection>(output: &[u8], connection: &mut C) -> Result<(), C::Error> {
    for piece in output.chunks(CONSOLE_PIECE_BYTES) {
        let digits = piece.iter().flat_map(|byte| {
            let digit = |value: u8| b"0123456789abcdef"[usize::from(value & 15)];
            [digit(byte >> 4), digit(*byte)]
        });
        let body: Vec<u8> = std::iter::once(b'O').chain(digits).collect();
        let sum = body.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
        connection.write(b'$')?;
        connection.write_all(&body)?;
        connection.write_all(format!("#{sum:02x}").as_bytes())?;
        connection.flush()?;
    }
    Ok(())
}

struct EventLoop<C>(std::marker::PhantomData<C>);

impl<C: ConnectionExt> BlockingEventLoop for EventLoop<C> {
    type Target = DebugTarget;
    type Connection = C;
    type StopReason = MultiThreadStopReason<u32>;

    fn wait_for_stop_reason(
        target: &mut DebugTarget,
        conn: &mut C,
    ) -> Result<Event<Self::StopReason>, WaitForStopReasonError<Infallible, C::Error>> {
        loop {
            if conn
                .peek()
                .map_err(WaitForStopReasonError::Connection)?
                .is_some()
            {
                let byte = conn.read().map_err(WaitForStopReasonError::Connection)?;
                return Ok(Event::IncomingData(byte));
            }
            let reason = target.advance();
            send_console_output(&target.take_console(), conn)
                .map_err(WaitForStopReasonError::Connection)?;
            if let Some(reason) = reason {
                return Ok(Event::TargetStopped(reason));
            }
        }
    }

    fn on_interrupt(target: &mut DebugTarget) -> Result<Option<Self::StopReason>, Infallible> {
        Ok(Some(target.interrupt()))
    }
}

/// A TCP connection that looks at the caller's wish to stop while it waits.
struct Link<'a> {
    stream: TcpStream,
    received: Vec<u8>,
    taken: usize,
    begun: bool,
    outgoing: Vec<u8>,
    stop: &'a dyn Fn() -> bool,
}

impl<'a> Link<'a> {
    fn new(stream: TcpStream, stop: &'a dyn Fn() -> bool) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(Duration::from_secs(10)))?;
        Ok(Self {
            stream,
            received: Vec::new(),
            taken: 0,
            begun: false,
            outgoing: Vec::new(),
            stop,
        })
    }

    /// Take in what has come; false when nothing has.
    fn receive(&mut self, wait: bool) -> io::Result<bool> {
        if self.taken < self.received.len() {
            return Ok(true);
        }
        if !self.outgoing.is_empty() {
            self.flush()?;
        }
        self.stream.set_nonblocking(!wait)?;
        self.stream.set_read_timeout(Some(PATIENCE))?;
        let mut buffer = [0; 4096];
        match Read::read(&mut self.stream, &mut buffer) {
            Ok(0) => Err(io::Error::new(
                ErrorKind::UnexpectedEof,
                "GDB closed the connection",
            )),
            Ok(_) if !self.begun && !FIRST_BYTES.contains(&buffer[0]) => Err(io::Error::new(
                ErrorKind::InvalidData,
                "what connected is no GDB",
            )),
            Ok(count) => {
                self.begun = true;
                self.received = buffer[..count].to_vec();
                self.taken = 0;
                Ok(true)
            }
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) =>
            {
                Ok(false)
            }
            Err(error) => Err(error),
        }
    }

    fn check(&self) -> io::Result<()> {
        if (self.stop)() {
            return Err(io::Error::new(
                ErrorKind::Interrupted,
                "the server was told to stop",
            ));
        }
        Ok(())
    }
}

impl Connection for Link<'_> {
    type Error = io::Error;

    fn write(&mut self, byte: u8) -> io::Result<()> {
        self.outgoing.push(byte);
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.set_nonblocking(false)?;
        Write::write_all(&mut self.stream, &self.outgoing)?;
        self.outgoing.clear();
        Write::flush(&mut self.stream)
    }
}

impl ConnectionExt for Link<'_> {
    fn read(&mut self) -> io::Result<u8> {
        while !self.receive(true)? {
            self.check()?;
        }
        let byte = self.received[self.taken];
        self.taken += 1;
        Ok(byte)
    }

    fn peek(&mut self) -> io::Result<Option<u8>> {
        self.check()?;
        if !self.receive(false)? {
            return Ok(None);
        }
        Ok(self.received.get(self.taken).copied())
    }
}
