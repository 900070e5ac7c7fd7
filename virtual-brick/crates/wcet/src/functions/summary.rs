// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The graph of one function for any arguments: exploration and value analysis by turns, until
//! every branch is resolved.

use crate::error::Error;
use crate::functions::program::Program;
use crate::graph::control_flow::{Block, Entry, Explorer, Flow, Node, Target, Transfer};
use crate::graph::loop_forest::Forest;
use crate::graph::node_splitting::reducible;
use crate::paths::block_cost::{block_costs, BlockCost};
use crate::values::block::{any_arguments, changed_registers, Outcome, Walker};
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::instruction::Operation;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Visits of a block after which growing values give up.
const PATIENCE: u32 = 4;

/// Elements up to which a set may grow all the same, where a branch is not resolved otherwise: the
/// entries of a jump table whose index is a loop's counter.
const TABLE: usize = 64;

/// What is true of a function whatever its arguments.
#[derive(Debug)]
pub struct Summary {
    /// Its graph.
    pub flow: Flow,
    /// Its loops.
    pub forest: Forest,
    /// Some way returns.
    pub returns: bool,
    /// Registers of r0 to r12 that it does not preserve.
    pub changed: u16,
    /// The same for all functions it calls.
    pub callees: BTreeMap<Entry, u16>,
    /// Number of each loop within its symbol.
    pub numbers: Vec<usize>,
    /// What holds at each block, whatever the arguments; none where nothing leads.
    pub states: Vec<Option<State>>,
    /// Costs of its blocks.
    pub costs: Vec<BlockCost>,
    /// Blocks that are not executed in what is bounded.
    pub avoided: Vec<bool>,
    /// Header executions of each loop, as the user says.
    pub limits: Vec<Option<u64>>,
    /// The same where some function is under way: loop, function, header executions.
    pub limits_in: Vec<(usize, Entry, u64)>,
    /// How often its blocks were executed in a closed program; empty before.
    pub visits: RefCell<Vec<u64>>,
}

/// Registers that a function may change (procedure call standard, 6.1.1).
const SCRATCH: u16 = 0b0001_0000_0000_1111;

impl Summary {
    /// What is assumed of a recursive function at its inner calls, and checked afterwards.
    pub fn of_recursion() -> Self {
        Self {
            flow: Flow::default(),
            forest: Forest::default(),
            returns: true,
            changed: SCRATCH,
            callees: BTreeMap::new(),
            numbers: Vec::new(),
            states: Vec::new(),
            costs: Vec::new(),
            avoided: Vec::new(),
            limits: Vec::new(),
            limits_in: Vec::new(),
            visits: RefCell::default(),
        }
    }

    /// Header executions of each loop, as the user says, while these functions are under way.
    pub fn limits_within(&self, open: &[Entry]) -> Vec<Option<u64>> {
        let mut limits = self.limits.clone();
        for (index, function, bound) in &self.limits_in {
            if open.contains(function) {
                let known = limits[*index].unwrap_or(u64::MAX);
                limits[*index] = Some(known.min(*bound));
            }
        }
        limits
    }
}

struct Fixpoint {
    states: Vec<Option<State>>,
    transfers: BTreeMap<Node, Transfer>,
    changed: u16,
    returns: bool,
}

/// A graph whose branches are resolved, and what its values are.
struct Resolved {
    flow: Flow,
    fixpoint: Fixpoint,
    /// What callees do not preserve.
    changed: BTreeMap<Entry, u16>,
    /// Elements up to which sets grew.
    kept: usize,
}

/// Explores and finds values by turns.
fn resolve_branches(program: &Program<'_>, entry: Entry) -> Result<Resolved, Error> {
    let mut resolved = BTreeMap::new();
    let mut returning: BTreeMap<Entry, bool> = BTreeMap::new();
    let mut changed = BTreeMap::new();
    let mut kept = 0;
    loop {
        let flow = match explore(program, entry, &resolved, &returning) {
            Err(Error::NoCode(_)) if kept < TABLE && !resolved.is_empty() => {
                kept = TABLE;
                resolved.clear();
                continue;
            }
            explored => explored?,
        };
        let new = new_callees(&flow, &returning);
        for (callee, site) in &new {
            let summary = program.summary(*callee, *site)?;
            returning.insert(*callee, summary.returns);
            changed.insert(*callee, summary.changed);
        }
        if !new.is_empty() {
            continue;
        }
        let fixpoint = iterate(program, &flow, &changed, entry, kept)?;
        if let Some(node) = unresolved(&fixpoint.transfers, &resolved) {
            if kept == TABLE {
                return Err(Error::UnresolvedBranch(program.image.place(node.address)));
            }
            kept = TABLE;
            resolved.clear();
        } else if fixpoint.transfers != resolved {
            resolved = fixpoint.transfers;
        } else {
            return Ok(Resolved {
                flow,
                fixpoint,
                changed,
                kept,
            });
        }
    }
}

/// Functions called for the first time, each with a place where that happens.
fn new_callees(flow: &Flow, known: &BTreeMap<Entry, bool>) -> Vec<(Entry, u32)> {
    let mut new = Vec::new();
    for block in &flow.blocks {
        let last = block.instructions.last();
        let site = last.map_or(block.node.address, |(address, _)| *address);
        let unknown = block
            .calls
            .iter()
            .filter(|callee| !known.contains_key(*callee));
        new.extend(unknown.map(|callee| (*callee, site)));
    }
    new
}

/// Computes the summary of a function; summaries of callees come from the program.
pub fn summarise(program: &Program<'_>, entry: Entry) -> Result<Summary, Error> {
    let Resolved {
        flow,
        mut fixpoint,
        changed,
        kept,
    } = resolve_branches(program, entry)?;
    if program.given_recursion(entry).is_some() && fixpoint.changed & !SCRATCH != 0 {
        return Err(Error::Recursion(vec![program.image.place(entry.0)]));
    }
    let block_count = flow.blocks.len();
    let places: Vec<u32> = flow.blocks.iter().map(|block| block.node.address).collect();
    let (flow, forest) = reducible(flow).map_err(|block| {
        let place = places.get(block).copied().unwrap_or(entry.0);
        Error::Irreducible(program.image.place(place))
    })?;
    if flow.blocks.len() > block_count {
        fixpoint = iterate(program, &flow, &changed, entry, kept)?;
    }
    let numbers = program.loop_numbers(&flow, &forest);
    let (limits, limits_in) = program.given_bounds(&flow, &forest, &numbers);
    Ok(Summary {
        costs: block_costs(program.map, &flow)?,
        avoided: program.avoided(&flow),
        limits,
        limits_in,
        visits: RefCell::default(),
        numbers,
        states: fixpoint.states,
        flow,
        forest,
        returns: fixpoint.returns,
        changed: fixpoint.changed,
        callees: changed,
    })
}

fn explore(
    program: &Program<'_>,
    entry: Entry,
    resolved: &BTreeMap<Node, Transfer>,
    returning: &BTreeMap<Entry, bool>,
) -> Result<Flow, Error> {
    Explorer {
        image: program.image,
        entry,
        resolved,
        dead: &|address| program.is_dead(address),
        returns: &|callee| returning.get(&callee).copied().unwrap_or(false),
        parks: &program.conventions.parks,
    }
    .explore()
}

/// States at all blocks for any arguments, and from them the targets of indirect branches. Sets of
/// up to `kept` elements may grow.
fn iterate(
    program: &Program<'_>,
    flow: &Flow,
    changed: &BTreeMap<Entry, u16>,
    entry: Entry,
    kept: usize,
) -> Result<Fixpoint, Error> {
    let region = |_| None;
    let mut walker = Walker::new(program.world(), flow, changed, &region);
    let mut states: Vec<Option<State>> = vec![None; flow.blocks.len()];
    let mut visits = vec![0_u32; flow.blocks.len()];
    states[0] = Some(State::entry(&any_arguments()));
    let mut open = BTreeSet::from([0]);
    let mut fixpoint = Fixpoint {
        states: Vec::new(),
        transfers: BTreeMap::new(),
        changed: 0,
        returns: false,
    };
    while let Some(index) = open.pop_first() {
        let Some(state) = states[index].clone() else {
            continue;
        };
        let outcome = walker.run(index, state);
        resolve(
            program,
            flow,
            entry,
            index,
            &outcome,
            &mut fixpoint.transfers,
        );
        for (number, state) in outcome.edges {
            let Target::Block(next) = flow.blocks[index].edges[number].target else {
                check_return(program, flow, index, &state)?;
                fixpoint.returns = true;
                fixpoint.changed |= changed_registers(&state);
                continue;
            };
            let merged = match &states[next] {
                None => state,
                Some(old) if visits[next] < PATIENCE => old.join(&state),
                Some(old) => old.widen(&state, kept, |value| program.map.pointer_region(value)),
            };
            if states[next].as_ref() != Some(&merged) {
                visits[next] += 1;
                states[next] = Some(merged);
                open.insert(next);
            }
        }
    }
    program.note_steps(walker.step_count);
    fixpoint.states = states;
    Ok(fixpoint)
}

fn check_return(
    program: &Program<'_>,
    flow: &Flow,
    index: usize,
    state: &State,
) -> Result<(), Error> {
    let block = &flow.blocks[index];
    let address = block
        .instructions
        .last()
        .map_or(block.node.address, |(a, _)| *a);
    if state.registers[13] == Value::Stack(0) || program.leaves(address) {
        return Ok(());
    }
    Err(Error::StackNotRestored(program.image.place(address)))
}

/// Notes the transfer that the value of r15 at the end of a block means.
fn resolve(
    program: &Program<'_>,
    flow: &Flow,
    entry: Entry,
    index: usize,
    outcome: &Outcome,
    transfers: &mut BTreeMap<Node, Transfer>,
) {
    let block = &flow.blocks[index];
    let (Some((address, instruction)), Some(value)) = (block.instructions.last(), &outcome.target)
    else {
        return;
    };
    let direct = matches!(
        instruction.operation,
        Operation::Branch { .. } | Operation::LongBranchSuffix { .. }
    );
    if direct && block.transfer != Some(Transfer::Unresolved) && !parks(program, block) {
        return;
    }
    let node = Node {
        address: *address,
        ..block.node
    };
    let exchanges = matches!(instruction.operation, Operation::BranchExchange { .. });
    let next = address.wrapping_add(instruction.size);
    let link = outcome.link.as_ref().and_then(Value::constant);
    let calls = link.is_some_and(|link| link & !1 == next);
    let transfer = if *value == Value::entry(14) {
        Transfer::Return
    } else if let Some(elements) = value.elements() {
        let targets = elements.iter().map(|target| {
            let thumb = if exchanges {
                target & 1 != 0
            } else {
                node.thumb
            };
            (target & if thumb { !1 } else { !3 }, thumb)
        });
        classify(program, entry, node, targets.collect(), calls)
    } else {
        let caller = Some(node.copy).filter(|site| *site != 0);
        let for_it = || program.given_targets(caller?);
        match program.given_targets(*address).or_else(for_it) {
            Some(targets) if calls => Transfer::Call(targets),
            _ if program.leaves(*address) => Transfer::Return,
            Some(targets) => Transfer::TailCall(targets),
            None => Transfer::Unresolved,
        }
    };
    let link = link.filter(|_| node.copy != 0);
    transfers.insert(node, for_caller(transfer, link));
}

/// A local subroutine that leaves the function with a link into it comes back there.
fn for_caller(transfer: Transfer, link: Option<u32>) -> Transfer {
    match (transfer, link) {
        (Transfer::TailCall(targets), Some(link)) => {
            let back = Node {
                copy: 0,
                address: link & !1,
                thumb: link & 1 != 0,
            };
            Transfer::CallFor(targets, back)
        }
        (transfer, _) => transfer,
    }
}

/// A branch that stays unresolved, or becomes so when what it leads to is known.
fn unresolved(
    transfers: &BTreeMap<Node, Transfer>,
    before: &BTreeMap<Node, Transfer>,
) -> Option<Node> {
    let unknown = transfers
        .iter()
        .find(|(node, transfer)| **transfer == Transfer::Unresolved && before.contains_key(*node));
    unknown.map(|(node, _)| *node)
}

/// Is the branch at the end of a block to a function that takes the processor?
fn parks(program: &Program<'_>, block: &Block) -> bool {
    let Some((address, instruction)) = block.instructions.last() else {
        return false;
    };
    let Operation::Branch { offset, .. } = instruction.operation else {
        return false;
    };
    let target = address
        .wrapping_add(2 * instruction.size)
        .wrapping_add(offset);
    program.conventions.parks.contains(&target)
}

fn classify(
    program: &Program<'_>,
    entry: Entry,
    node: Node,
    targets: Vec<Entry>,
    calls: bool,
) -> Transfer {
    if calls {
        return Transfer::Call(targets);
    }
    let function = |target: &Entry| *target != entry && program.image.starts_function(target.0);
    if targets.iter().all(function) {
        return Transfer::TailCall(targets);
    }
    let nodes = targets.iter().map(|(address, thumb)| Node {
        copy: if returns_from_copy(program, node, *address) {
            0
        } else {
            node.copy
        },
        address: *address,
        thumb: *thumb,
    });
    Transfer::Jump(nodes.collect())
}

/// Back from a switch helper or a local subroutine to the code that called it.
fn returns_from_copy(program: &Program<'_>, node: Node, target: u32) -> bool {
    let size = if node.thumb { 2 } else { 4 };
    target == node.copy.wrapping_add(size)
        || program.image.names_at(target) != program.image.names_at(node.address)
}
