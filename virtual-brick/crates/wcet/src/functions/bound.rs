// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Bounds of one function: time, stack, and the path that attains the time.

use crate::error::{Error, MissingBound};
use crate::functions::calls::Follower;
use crate::functions::program::Program;
use crate::functions::summary::Summary;
use crate::graph::control_flow::{Block, Entry, Target};
use crate::graph::loop_forest::Forest;
use crate::loops::abstract_execution::{Execution, LoopFinding};
use crate::paths::block_cost::{edge_cycles, Outside};
use crate::paths::critical_section::{merge, Sections, Stay};
use crate::paths::longest_path::{longest_path, Problem, Solution, Unsolved};
use crate::values::block::{as_arguments, BlockRecord, Walker};
use crate::values::state::{State, ENDLESS};
use std::collections::BTreeSet;
use std::rc::Rc;

/// Where a loop's bound comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// From the code.
    Found,
    /// From the user.
    Given,
    /// There is none, and none is needed: no way through the loop returns.
    NotNeeded,
}

/// A loop of the function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopBound {
    /// Address of the header.
    pub address: u32,
    /// Number within its symbol.
    pub number: usize,
    /// Most executions of the header for one entry.
    pub header_executions: Option<u64>,
    /// Who says so.
    pub origin: Origin,
    /// Its header as a position among the blocks.
    pub header: usize,
    /// All its blocks.
    pub blocks: Vec<usize>,
    /// Header executions beyond the first of each entry, in all for one entry of the loop around
    /// it, and the position of that loop's header.
    pub repeats: Option<(u64, usize)>,
}

/// A block as the longest path passes it.
#[derive(Clone, Debug)]
pub struct BlockBound {
    /// First instruction.
    pub address: u32,
    /// Number of instructions.
    pub instruction_count: usize,
    /// How often the path passes.
    pub count: u64,
    /// Cycles by way out, calls included; none for a way that is never taken.
    pub cycles: Vec<Option<u64>>,
    /// Bounds of the functions called at its end.
    pub calls: Vec<Rc<FunctionBound>>,
    /// Accesses whose region is not known, charged as the dearest.
    pub unknown_accesses: usize,
    /// Blocks to which the ways out lead; none for the return.
    pub targets: Vec<Option<usize>>,
    /// Addresses of its instructions.
    pub addresses: Vec<u32>,
}

/// Bounds of one function for one set of arguments.
#[derive(Debug)]
pub struct FunctionBound {
    /// Entry.
    pub entry: Entry,
    /// Cycles from its first instruction to its last, without the fetches of the return: the
    /// smaller of the longest path and of the longest way with calls followed.
    pub cycles: u64,
    /// Cycles of the longest path, on which each block costs what it can cost at most.
    pub path_cycles: u64,
    /// Stack below the stack pointer at entry, with all callees; `None` when not bounded.
    pub stack_bytes: Option<u32>,
    /// Blocks by address, with the longest path.
    pub blocks: Vec<BlockBound>,
    /// Loops by address of their header.
    pub loops: Vec<LoopBound>,
    /// Longest stays in protected actions, here and in all callees.
    pub sections: Sections,
}

/// What executing a function on abstract values shows.
struct Executed {
    findings: Vec<LoopFinding>,
    records: Vec<BlockRecord>,
    /// Longest way with calls followed, if each loop on it has a bound.
    elapsed: Option<u64>,
}

fn execute(program: &Program<'_>, entry: Entry, summary: &Summary, state: State) -> Executed {
    let (flow, forest) = (&summary.flow, &summary.forest);
    let region = |address| program.given_region(address);
    let follower = Follower::new(program, entry, false);
    let mut walker = Walker::new(program.world(), flow, &summary.callees, &region);
    walker.costs = &summary.costs;
    walker.calls = Some(&follower);
    walker.avoided = &summary.avoided;
    let limits = summary.limits_within(&[entry]);
    let mut execution = Execution::new(walker, forest, limits);
    let exits = execution.run(state);
    program.note_steps(execution.walker.step_count);
    let returns = exits
        .iter()
        .filter(|((block, edge), _)| flow.blocks[*block].edges[*edge].target == Target::Return);
    let longest = returns.map(|(_, state)| state.elapsed.0).max();
    Executed {
        elapsed: longest.filter(|cycles| *cycles != ENDLESS),
        findings: execution.findings,
        records: execution.walker.records,
    }
}

/// Stack of a function with all it calls, also of one that never returns.
pub fn stack_of(
    program: &Program<'_>,
    entry: Entry,
    summary: &Summary,
) -> Result<Option<u32>, Error> {
    let state = State::entry(&crate::values::block::any_arguments());
    let executed = execute(program, entry, summary, state);
    let (calls, _) = called(program, summary, &executed.records)?;
    Ok(stack_bound(&executed.records, &calls))
}

/// The inner call of a recursive function: its time and stack are the outer one's.
pub fn recursive_call(entry: Entry) -> FunctionBound {
    FunctionBound {
        entry,
        cycles: 0,
        path_cycles: 0,
        stack_bytes: Some(0),
        blocks: Vec::new(),
        loops: Vec::new(),
        sections: Sections::new(),
    }
}

/// A call that has a bound only where it is followed.
fn followed_call(entry: Entry, cycles: u64) -> FunctionBound {
    FunctionBound {
        cycles,
        stack_bytes: None,
        ..recursive_call(entry)
    }
}

/// A recursive function from one activation.
pub fn bound_recursive(one: FunctionBound, calls: u64, depth: u32) -> FunctionBound {
    FunctionBound {
        cycles: one.cycles.saturating_mul(calls),
        stack_bytes: one.stack_bytes.and_then(|bytes| bytes.checked_mul(depth)),
        ..one
    }
}

/// Bounds a function whose summary is known, from a state at its entry.
pub fn bound_summary(
    program: &Program<'_>,
    entry: Entry,
    summary: &Summary,
    state: State,
) -> Result<FunctionBound, Error> {
    let (flow, forest) = (&summary.flow, &summary.forest);
    let Executed {
        findings,
        records,
        elapsed,
    } = execute(program, entry, summary, state);
    let given = summary.limits_within(&[entry]);
    let (calls, endless) = called(program, summary, &records)?;
    let nodes: Vec<Entry> = flow
        .blocks
        .iter()
        .map(|block| (block.node.address, block.node.thumb))
        .collect();
    let mut cycles = Vec::new();
    for (index, block) in flow.blocks.iter().enumerate() {
        let outside = Outside {
            map: program.map,
            call_cycles: call_cycles(program, block, &calls[index], &records[index])?,
        };
        let mut ways = edge_cycles(&outside, block, &records[index], &nodes)?;
        for (way, edge) in ways.iter_mut().zip(&block.edges) {
            *way = way.filter(|_| !(endless.contains(&index) && edge.executed));
        }
        cycles.push(ways);
    }
    let bounds: Vec<Option<u64>> = findings.iter().zip(&given).map(effective).collect();
    let problem = Problem {
        flow,
        forest,
        cycles: &cycles,
        bounds: &bounds,
        repeats: &repeats(&findings, forest),
    };
    let solution =
        longest_path(&problem).map_err(|unsolved| explain(program, entry, summary, unsolved))?;
    let stay = Stay {
        flow,
        forest,
        bounds: &bounds,
        records: &records,
        cycles: &cycles,
    };
    let mut sections = stay.sections()?;
    let unlocks = &program.conventions.unlocks;
    for callee in calls.iter().flatten() {
        if !unlocks.contains(&callee.entry.0) {
            merge(&mut sections, &callee.sections);
        }
    }
    let stack_bytes = stack_bound(&records, &calls);
    let loops = loop_bounds(summary, &findings, &given, &bounds);
    Ok(FunctionBound {
        entry,
        path_cycles: solution.cycles,
        cycles: elapsed.map_or(solution.cycles, |way| way.min(solution.cycles)),
        stack_bytes,
        loops,
        sections,
        blocks: block_bounds(summary, &solution, cycles, calls, &records),
    })
}

fn loop_bounds(
    summary: &Summary,
    findings: &[LoopFinding],
    given: &[Option<u64>],
    bounds: &[Option<u64>],
) -> Vec<LoopBound> {
    let loops = summary.forest.loops.iter().enumerate();
    let repeats = repeats(findings, &summary.forest);
    let around = |index: usize| {
        let parent = summary.forest.loops[index].parent?;
        Some((repeats[index]?, summary.forest.loops[parent].header))
    };
    loops
        .map(|(index, found)| LoopBound {
            repeats: around(index),
            address: summary.flow.blocks[found.header].node.address,
            number: summary.numbers[index],
            header_executions: bounds[index],
            origin: origin(&findings[index], given[index]),
            header: found.header,
            blocks: found.blocks.iter().copied().collect(),
        })
        .collect()
}

fn origin(finding: &LoopFinding, given: Option<u64>) -> Origin {
    match (finding.unbounded || finding.cut, given) {
        (false, _) => Origin::Found,
        (true, Some(_)) => Origin::Given,
        (true, None) => Origin::NotNeeded,
    }
}

/// The smaller of what was found and what was given.
fn effective((finding, given): (&LoopFinding, &Option<u64>)) -> Option<u64> {
    if finding.unbounded {
        return *given;
    }
    let found = finding.header_executions;
    Some(given.map_or(found, |given| given.min(found)))
}

/// Repetitions of inner loops, where both the loop and the one around it were followed exactly.
fn repeats(findings: &[LoopFinding], forest: &Forest) -> Vec<Option<u64>> {
    let exact = |index: usize| !findings[index].unbounded;
    let all = forest.loops.iter().enumerate().map(|(index, found)| {
        let parent = found.parent?;
        (exact(index) && exact(parent)).then_some(findings[index].repeats)
    });
    all.collect()
}

/// Bounds of the functions called at the end of each block, and the blocks whose calls never
/// return with the arguments they have.
type Called = (Vec<Vec<Rc<FunctionBound>>>, BTreeSet<usize>);

fn called(
    program: &Program<'_>,
    summary: &Summary,
    records: &[BlockRecord],
) -> Result<Called, Error> {
    let (mut all, mut endless) = (Vec::new(), BTreeSet::new());
    for (index, block) in summary.flow.blocks.iter().enumerate() {
        let mut bounds = Vec::new();
        let arguments = records[index].arguments.as_ref().map(as_arguments);
        let reached = &records[index].callees;
        for (callee, known) in block
            .calls
            .iter()
            .filter(|callee| reached.contains(callee))
            .flat_map(|c| arguments.iter().map(move |a| (c, a)))
        {
            match program.bound(*callee, known) {
                Ok(bound) => bounds.push(bound),
                Err(Error::NeverReturns(_)) => {}
                Err(error @ Error::MissingBounds(_)) => match records[index].callee_cycles {
                    Some(cycles) if cycles != ENDLESS => {
                        bounds.push(Rc::new(followed_call(*callee, cycles)));
                    }
                    _ => return Err(error),
                },
                Err(error) => return Err(error),
            }
        }
        if arguments.is_some() && bounds.is_empty() {
            endless.insert(index);
        }
        all.push(bounds);
    }
    Ok((all, endless))
}

/// Time of the call at the end of a block: the callee and, unless the block's function ends with
/// it, the fetches after its return.
fn call_cycles(
    program: &Program<'_>,
    block: &Block,
    calls: &[Rc<FunctionBound>],
    record: &BlockRecord,
) -> Result<u64, Error> {
    let apart = calls.iter().map(|bound| bound.cycles).max().unwrap_or(0);
    let callee = record
        .callee_cycles
        .map_or(apart, |followed| followed.min(apart));
    let back = block.resumes();
    let refill = back.map_or(Ok(0), |(address, thumb)| program.map.refill(address, thumb))?;
    Ok(callee + refill)
}

fn stack_bound(records: &[BlockRecord], calls: &[Vec<Rc<FunctionBound>>]) -> Option<u32> {
    let mut most = 0;
    for (record, callees) in records.iter().zip(calls) {
        most = most.max(record.depth_bytes?);
        for callee in callees {
            most = most.max(record.call_depth_bytes? + callee.stack_bytes?);
        }
    }
    Some(most)
}

fn block_bounds(
    summary: &Summary,
    solution: &Solution,
    cycles: Vec<Vec<Option<u64>>>,
    calls: Vec<Vec<Rc<FunctionBound>>>,
    records: &[BlockRecord],
) -> Vec<BlockBound> {
    let parts = cycles.into_iter().zip(calls).zip(records).enumerate();
    parts
        .map(|(index, ((cycles, calls), record))| BlockBound {
            address: summary.flow.blocks[index].node.address,
            instruction_count: summary.flow.blocks[index].instructions.len(),
            count: solution.counts[index],
            cycles,
            calls,
            targets: targets(&summary.flow.blocks[index]),
            addresses: summary.flow.blocks[index]
                .instructions
                .iter()
                .map(|(address, _)| *address)
                .collect(),
            unknown_accesses: record
                .instructions
                .iter()
                .filter(|i| i.unknown_address)
                .count(),
        })
        .collect()
}

fn targets(block: &Block) -> Vec<Option<usize>> {
    let edges = block.edges.iter();
    edges
        .map(|edge| match edge.target {
            Target::Block(next) => Some(next),
            Target::Return => None,
        })
        .collect()
}

/// A loop as it is asked for.
pub fn missing_bound(program: &Program<'_>, summary: &Summary, index: usize) -> MissingBound {
    let header = summary.forest.loops[index].header;
    let lines = program.own_lines(&summary.flow, &summary.forest, index);
    MissingBound {
        place: program
            .image
            .place(summary.flow.blocks[header].node.address),
        index: summary.numbers[index],
        lines: lines.into_iter().collect(),
    }
}

fn explain(program: &Program<'_>, entry: Entry, summary: &Summary, unsolved: Unsolved) -> Error {
    match unsolved {
        Unsolved::Unbounded(loops) => {
            let missing = loops.into_iter();
            let missing = missing.map(|index| missing_bound(program, summary, index));
            Error::MissingBounds(missing.collect())
        }
        Unsolved::NoReturn => Error::NeverReturns(program.image.place(entry.0)),
    }
}
