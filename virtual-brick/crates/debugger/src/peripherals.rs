// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Peripheral registers by name (AT91SAM7S256 datasheet, "User Interface" of each chapter).

use std::fmt::Write;

use virtual_brick::VirtualBrick;

/// A peripheral: its name, base address, and registers that can be read, by offset.
struct Peripheral {
    name: &'static str,
    base: u32,
    registers: &'static [(u32, &'static str)],
}

const TIMER: &[(u32, &str)] = &[
    (0x04, "CMR"),
    (0x10, "CV"),
    (0x14, "RA"),
    (0x18, "RB"),
    (0x1C, "RC"),
    (0x20, "SR"),
    (0x2C, "IMR"),
];

const PERIPHERALS: [Peripheral; 14] = [
    timer("TC0", 0xFFFA_0000),
    timer("TC1", 0xFFFA_0040),
    timer("TC2", 0xFFFA_0080),
    Peripheral {
        name: "TWI",
        base: 0xFFFB_8000,
        registers: &[(0x04, "MMR"), (0x10, "CWGR"), (0x20, "SR"), (0x2C, "IMR")],
    },
    Peripheral {
        name: "PWMC",
        base: 0xFFFC_C000,
        registers: &[(0x00, "MR"), (0x0C, "SR"), (0x18, "IMR")],
    },
    Peripheral {
        name: "SSC",
        base: 0xFFFD_4000,
        registers: &[(0x04, "CMR"), (0x40, "SR"), (0x4C, "IMR")],
    },
    Peripheral {
        name: "ADC",
        base: 0xFFFD_8000,
        registers: &[(0x04, "MR"), (0x18, "CHSR"), (0x1C, "SR"), (0x2C, "IMR")],
    },
    Peripheral {
        name: "SPI",
        base: 0xFFFE_0000,
        registers: &[(0x04, "MR"), (0x10, "SR"), (0x1C, "IMR"), (0x30, "CSR0")],
    },
    Peripheral {
        name: "AIC",
        base: 0xFFFF_F000,
        registers: &[
            (0x108, "ISR"),
            (0x10C, "IPR"),
            (0x110, "IMR"),
            (0x114, "CISR"),
        ],
    },
    Peripheral {
        name: "PIOA",
        base: 0xFFFF_F400,
        registers: &[
            (0x08, "PSR"),
            (0x18, "OSR"),
            (0x38, "ODSR"),
            (0x3C, "PDSR"),
            (0x48, "IMR"),
            (0x70, "ABSR"),
        ],
    },
    Peripheral {
        name: "PMC",
        base: 0xFFFF_FC00,
        registers: &[
            (0x08, "SCSR"),
            (0x18, "PCSR"),
            (0x20, "MOR"),
            (0x24, "MCFR"),
            (0x2C, "PLLR"),
            (0x30, "MCKR"),
            (0x68, "SR"),
        ],
    },
    Peripheral {
        name: "RTT",
        base: 0xFFFF_FD20,
        registers: &[(0x0, "MR"), (0x4, "AR"), (0x8, "VR"), (0xC, "SR")],
    },
    Peripheral {
        name: "PIT",
        base: 0xFFFF_FD30,
        registers: &[(0x0, "MR"), (0x4, "SR"), (0xC, "PIIR")],
    },
    Peripheral {
        name: "WDT",
        base: 0xFFFF_FD40,
        registers: &[(0x4, "MR"), (0x8, "SR")],
    },
];

const fn timer(name: &'static str, base: u32) -> Peripheral {
    Peripheral {
        name,
        base,
        registers: TIMER,
    }
}

/// Registers of the peripherals whose name contains `part`, read on a copy of the chip.
pub(crate) fn show(brick: &VirtualBrick, part: &str) -> String {
    let wanted = part.to_uppercase();
    let mut text = String::new();
    let named = PERIPHERALS.iter().filter(|p| p.name.contains(&wanted));
    for peripheral in named {
        for (offset, register) in peripheral.registers {
            let address = peripheral.base + offset;
            let name = format!("{} {register}", peripheral.name);
            let shown = match brick.read_bus(address, 4) {
                Ok(bytes) => bytes.iter().rev().fold(String::new(), |mut text, byte| {
                    let _ = write!(text, "{byte:02X}");
                    text
                }),
                Err(_) => "cannot be read".to_owned(),
            };
            let _ = writeln!(text, "{name:<12}{address:08X}  {shown}");
        }
    }
    if text.is_empty() {
        let names: Vec<_> = PERIPHERALS.iter().map(|p| p.name).collect();
        text = format!("no peripheral '{part}'; there are {}\n", names.join(", "));
    }
    text
}
