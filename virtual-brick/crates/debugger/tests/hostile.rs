// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Whatever comes over the connection, the server answers or ends the session.

use std::sync::OnceLock;

use crate::gdb::{packet, Client};
use crate::support::arm::{Program, ALWAYS};
use crate::support::cases::cases;
use debugger::{session, DebugTarget};
use proptest::prelude::*;
use virtual_brick::VirtualBrick;

fn looping() -> VirtualBrick {
    static BRICK: OnceLock<VirtualBrick> = OnceLock::new();
    let make = || {
        let mut program = Program::new();
        program.load(1, 0x0020_8000);
        let again = program.here();
        program.add(0, 1).str(0, 1, 0).branch(ALWAYS, again);
        crate::support::brick(&program)
    };
    BRICK.get_or_init(make).clone()
}

fn send(target: &mut DebugTarget, bytes: Vec<u8>) {
    let client = Client {
        sent: bytes.into(),
        got: &mut Vec::new(),
        impatient: true,
    };
    session(target, client);
}

const HEADS: &[&str] = &[
    "m",
    "M",
    "X",
    "p",
    "P",
    "g",
    "G",
    "H",
    "Hg",
    "Hc",
    "T",
    "z",
    "Z",
    "Z0,",
    "Z2,",
    "Z4,",
    "vCont",
    "vCont;s:",
    "vCont;r",
    "vCont;c",
    "c",
    "s",
    "bs",
    "bc",
    "qRcmd,",
    "qSupported",
    "qXfer:features:read:target.xml:",
    "qXfer:memory-map:read::",
    "qThreadExtraInfo,",
    "qfThreadInfo",
    "qsThreadInfo",
    "?",
    "vMustReplyEmpty",
    "vFlashErase:",
    "vFlashWrite:",
    "vFlashDone",
    "QStartNoAckMode",
    "D",
    "!",
    "R",
];

/// Packets that begin as GDB's do and go on as they like.
fn almost_right() -> impl Strategy<Value = Vec<u8>> {
    let tail = prop_oneof![
        "[0-9a-f,:;=.p-]{0,40}".prop_map(String::into_bytes),
        prop::collection::vec(any::<u8>(), 0..60),
    ];
    (prop::sample::select(HEADS), tail).prop_map(|(head, tail)| {
        let mut body = head.as_bytes().to_vec();
        body.extend(tail);
        packet(&body)
    })
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn packets_that_are_almost_right_never_panic(
        sent in prop::collection::vec(almost_right(), 1..40)
    ) {
        let mut target = DebugTarget::new(looping());
        // A refused packet ends the session, so each is also a session of its own.
        sent.iter().for_each(|packet| send(&mut target, packet.clone()));
        send(&mut target, sent.concat());
        let replies = crate::gdb::talk(&mut target, &["?", "qfThreadInfo"]);
        prop_assert!(replies[0].starts_with("T05thread:"), "{:?}", replies);
        prop_assert!(replies[1].starts_with('m'), "{:?}", replies);
    }

    #[test]
    fn arbitrary_bytes_never_panic(sent in prop::collection::vec(any::<u8>(), 0..400)) {
        send(&mut DebugTarget::new(looping()), sent);
    }

    #[test]
    fn monitor_commands_never_panic(line in "(set |signals |steps |)[ -~]{0,40}") {
        DebugTarget::new(looping()).monitor(&line);
    }
}

#[test]
fn the_end_of_the_address_space_and_huge_lengths_are_refused() {
    let mut target = DebugTarget::new(looping());
    for body in [
        "mfffffffc,8",
        "m0,ffffffff",
        "m200000,ffffffff",
        "Z2,ffffffff,ffffffff",
        "mffffff00,100",
    ] {
        send(&mut target, packet(body.as_bytes()));
    }
    send(&mut target, vec![b'$'; 100_000]);
    send(&mut target, packet(&[b'm'; 50_000]));
}
