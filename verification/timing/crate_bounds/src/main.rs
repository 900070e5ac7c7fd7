// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of the crate `response-time-analysis` for task sets on standard input.
//!
//! One set per line: `C T D J B` of each task in whole numbers, most urgent first, separated by
//! `;`. One line of output per set: `fp;blocked;edf`, each a list of bounds from the release,
//! separated by blanks, `-` where the crate finds none. `blocked` adds B, `edf` ignores J and B.

use response_time_analysis::arrival::Sporadic;
use response_time_analysis::demand::RBF;
use response_time_analysis::time::{Duration, Service};
use response_time_analysis::wcet::Scalar;
use response_time_analysis::{edf, fixed_point, fixed_priority};
use std::error::Error;
use std::io::{self, BufRead, Write};

type Load = RBF<Sporadic, Scalar>;

const LIMIT: u64 = 1 << 44;

struct Row {
    wcet: u64,
    period: u64,
    deadline: u64,
    jitter: u64,
    blocking: u64,
}

fn parse(text: &str) -> Result<Row, Box<dyn Error>> {
    let numbers = text
        .split_whitespace()
        .map(str::parse)
        .collect::<Result<Vec<u64>, _>>()?;
    match numbers[..] {
        [wcet, period, deadline, jitter, blocking] => Ok(Row {
            wcet,
            period,
            deadline,
            jitter,
            blocking,
        }),
        _ => Err(format!("expected 'C T D J B', found '{text}'").into()),
    }
}

fn load(row: &Row, jitter: u64) -> Load {
    RBF::new(
        Sporadic::new(Duration::from(row.period), Duration::from(jitter)),
        Scalar::new(Service::from(row.wcet)),
    )
}

fn shown(result: fixed_point::SearchResult) -> String {
    result.map_or("-".to_string(), |bound| u64::from(bound).to_string())
}

fn earliest_deadline(rows: &[Row], index: usize) -> String {
    let loads: Vec<Load> = rows.iter().map(|row| load(row, 0)).collect();
    let task = |other: usize| edf::fully_preemptive::Task {
        rbf: &loads[other],
        deadline: Duration::from(rows[other].deadline),
    };
    let others: Vec<_> = (0..rows.len())
        .filter(|other| *other != index)
        .map(task)
        .collect();
    let limit = Duration::from(LIMIT);
    shown(edf::fully_preemptive::dedicated_uniproc_rta(
        &task(index),
        &others,
        limit,
    ))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut output = io::BufWriter::new(io::stdout().lock());
    let limit = Duration::from(LIMIT);
    for line in io::stdin().lock().lines() {
        let rows = line?.split(';').map(parse).collect::<Result<Vec<_>, _>>()?;
        let loads: Vec<Load> = rows.iter().map(|row| load(row, row.jitter)).collect();
        let mut columns: [Vec<String>; 3] = Default::default();
        for (index, row) in rows.iter().enumerate() {
            let more_urgent = &loads[..index];
            columns[0].push(shown(
                fixed_priority::fully_preemptive::dedicated_uniproc_rta(
                    &loads[index],
                    more_urgent,
                    limit,
                ),
            ));
            let task = fixed_priority::floating_nonpreemptive::TaskUnderAnalysis {
                rbf: &loads[index],
                blocking_bound: Service::from(row.blocking),
            };
            columns[1].push(shown(
                fixed_priority::floating_nonpreemptive::dedicated_uniproc_rta(
                    &task,
                    more_urgent,
                    limit,
                ),
            ));
            columns[2].push(earliest_deadline(&rows, index));
        }
        let joined: Vec<String> = columns.iter().map(|column| column.join(" ")).collect();
        writeln!(output, "{}", joined.join(";"))?;
    }
    Ok(())
}
