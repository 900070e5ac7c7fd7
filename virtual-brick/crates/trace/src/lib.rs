// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Record of a run: events in the order of time, sampled signals, names, and one digest of all.
//!
//! Growth is bounded by explicit [`Limits`]; reaching one is an error that names it. Nothing here
//! knows how the record was made.

mod digest;
mod error;
mod event;
mod names;
mod record;
mod signals;

pub use digest::Digest;
pub use error::TraceError;
pub use event::{Event, EventKind, Events, IDLE, PACKED_EVENT_LENGTH};
pub use names::{NameSpace, Names};
pub use record::{Limits, Mark, Trace};
pub use signals::{Signal, Signals};
