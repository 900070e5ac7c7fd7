// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The scope: quantities sampled beside the record, which they do not change.

use virtual_brick::{ScalarKind, VirtualBrick};

/// Rows that wait to be taken; later ones are lost.
const ROWS_MAX: usize = 100_000;

/// What a channel shows.
#[derive(Clone, Debug)]
enum Source {
    /// Last sample of a recorded signal, by its position.
    Signal(usize),
    /// Level of a pin of the chip.
    Pin(u32),
    /// A scalar in memory.
    Scalar { address: u32, kind: ScalarKind },
}

/// Channels, their period, and the rows sampled so far: instant in cycles, then one value each.
#[derive(Debug, Default)]
pub struct Scope {
    sources: Vec<Source>,
    period_cycles: u64,
    next_cycles: u64,
    rows: Vec<f64>,
}

impl Scope {
    /// Show these channels every `period_cycles` from now on: `signal:NAME`, `pin:N`,
    /// `symbol:PATH` or `symbol:PATH:KIND`.
    pub fn choose(
        &mut self,
        brick: &VirtualBrick,
        channels: &[String],
        period_cycles: u64,
    ) -> Result<(), String> {
        if period_cycles == 0 {
            return Err("the period of the scope must be at least 1 cycle".to_owned());
        }
        let sources: Result<Vec<_>, _> = channels.iter().map(|c| source(brick, c)).collect();
        self.sources = sources?;
        self.period_cycles = period_cycles;
        self.next_cycles = brick.cycles();
        self.rows.clear();
        Ok(())
    }

    /// When the next row is due; the end of time without channels.
    pub fn next_cycles(&self) -> u64 {
        if self.sources.is_empty() {
            u64::MAX
        } else {
            self.next_cycles
        }
    }

    /// Take a row if one is due.
    pub fn sample(&mut self, brick: &VirtualBrick) {
        let now = brick.cycles();
        if self.next_cycles() > now {
            return;
        }
        self.next_cycles = (now / self.period_cycles + 1) * self.period_cycles;
        if self.rows.len() >= ROWS_MAX * (self.sources.len() + 1) {
            return;
        }
        self.rows.push(now as f64);
        let values = self.sources.iter().map(|source| value(brick, source));
        self.rows.extend(values);
    }

    /// The rows since the last call.
    pub fn take(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.rows)
    }
}

fn source(brick: &VirtualBrick, channel: &str) -> Result<Source, String> {
    let refused = || format!("`{channel}` is no channel; say signal:NAME, pin:N or symbol:PATH");
    let (kind, name) = channel.split_once(':').ok_or_else(refused)?;
    match kind {
        "signal" => {
            let position = brick.trace().signals().iter().position(|s| s.name == name);
            let position = position.ok_or_else(|| format!("this brick has no signal `{name}`"))?;
            Ok(Source::Signal(position))
        }
        "pin" => match name.parse::<u32>() {
            Ok(pin) if pin < 32 => Ok(Source::Pin(pin)),
            _ => Err(format!("`{name}` is no pin; expected 0 to 31")),
        },
        "symbol" => {
            let (path, kind) = name.split_once(':').unwrap_or((name, ""));
            let kind = match kind {
                "" => None,
                kind => Some(kind.parse::<ScalarKind>()?),
            };
            let probe = brick.read_scalar(path, kind).map_err(|e| e.to_string())?;
            Ok(Source::Scalar {
                address: probe.address,
                kind: probe.kind,
            })
        }
        _ => Err(refused()),
    }
}

fn value(brick: &VirtualBrick, source: &Source) -> f64 {
    match source {
        Source::Signal(position) => {
            let signal = brick.trace().signals().iter().nth(*position);
            let last = signal.and_then(|signal| signal.values.last().copied());
            last.unwrap_or(f64::NAN)
        }
        Source::Pin(pin) => f64::from(brick.pins() >> pin & 1),
        Source::Scalar { address, kind } => scalar(brick, *address, *kind),
    }
}

/// Value of a scalar in memory, NaN where there is none.
pub fn scalar(brick: &VirtualBrick, address: u32, kind: ScalarKind) -> f64 {
    brick
        .read_memory(address, kind.size() as usize)
        .map_or(f64::NAN, |bytes| kind.to_f64(&bytes))
}
