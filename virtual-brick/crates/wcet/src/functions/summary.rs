// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! The graph of one function for any arguments: exploration and value analysis by turns, until
//! every branch is resolved.

use crate::error::Error;
use crate::functions::function_summary::{FunctionSummary, SCRATCH};
use crate::functions::program::Program;
use crate::graph::control_flow::{
    Block, ControlFlowGraph, ControlTransfer, Explorer, Node, Target,
};
use crate::graph::node_splitting::{reducible, ReducibleGraph};
use crate::inputs::image::Entry;
use crate::values::block_interpreter::{
    any_arguments, changed_registers, BlockInterpreter, BlockOutcome,
};
use crate::values::state::State;
use crate::values::value::Value;
use arm7tdmi::instruction::Operation;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Visits of a block after which growing values give up.
const WIDENING_DELAY: u32 = 4;

/// Elements up to which a set may grow all the same, where a branch is not resolved otherwise: the
/// entries of a jump table whose index is a loop's counter.
const JUMP_TABLE_SIZE: usize = 64;

impl Program<'_> {
    /// Summary of a function called from `site`.
    pub fn summary(&self, entry: Entry, site: u32) -> Result<Rc<FunctionSummary>, Error> {
        if let Some(known) = self.summaries.borrow().get(&entry) {
            return Ok(Rc::clone(known));
        }
        let cycle = {
            let pending = self.summarising.borrow();
            let start = pending.iter().position(|(function, _)| *function == entry);
            start.map(|start| {
                pending[start + 1..]
                    .iter()
                    .map(|(_, at)| *at)
                    .collect::<Vec<_>>()
            })
        };
        if let Some(mut sites) = cycle {
            if self.memory_known || self.facts.recursion(entry).is_some() {
                return Ok(Rc::new(FunctionSummary::of_recursive_call()));
            }
            sites.push(site);
            let places = sites.iter().map(|at| self.image.place(*at));
            return Err(Error::Recursion(places.collect()));
        }
        self.summarising.borrow_mut().push((entry, site));
        let result = summarise(self, entry);
        self.summarising.borrow_mut().pop();
        let summary = Rc::new(result?);
        self.summaries
            .borrow_mut()
            .insert(entry, Rc::clone(&summary));
        Ok(summary)
    }
}

struct Fixpoint {
    states: Vec<Option<State>>,
    transfers: BTreeMap<Node, ControlTransfer>,
    changed: u16,
    returns: bool,
}

/// A graph whose branches are resolved, and what its values are.
struct Resolved {
    flow: ControlFlowGraph,
    fixpoint: Fixpoint,
    /// What callees do not preserve.
    changed: BTreeMap<Entry, u16>,
    /// Elements up to which sets grew.
    set_limit: usize,
}

/// Explores and finds values by turns.
fn resolve_branches(program: &Program<'_>, entry: Entry) -> Result<Resolved, Error> {
    let mut resolved = BTreeMap::new();
    let mut returning: BTreeMap<Entry, bool> = BTreeMap::new();
    let mut changed = BTreeMap::new();
    let mut set_limit = 0;
    loop {
        let flow = match explore(program, entry, &resolved, &returning) {
            Err(Error::NoCode(_)) if set_limit < JUMP_TABLE_SIZE && !resolved.is_empty() => {
                set_limit = JUMP_TABLE_SIZE;
                resolved.clear();
                continue;
            }
            explored => explored.map_err(|error| blame_branch(program, &resolved, error))?,
        };
        let new = new_callees(&flow, &returning);
        for (callee, site) in &new {
            let summary = program.summary(*callee, *site);
            let summary = summary.map_err(|error| blame_branch(program, &resolved, error))?;
            returning.insert(*callee, summary.returns);
            changed.insert(*callee, summary.changed);
        }
        if !new.is_empty() {
            continue;
        }
        let fixpoint = fixpoint_of(program, &flow, &changed, entry, set_limit)?;
        if let Some(node) = unresolved(&fixpoint.transfers, &resolved) {
            if set_limit == JUMP_TABLE_SIZE {
                return Err(Error::UnresolvedBranch(program.image.place(node.address)));
            }
            set_limit = JUMP_TABLE_SIZE;
            resolved.clear();
        } else if fixpoint.transfers != resolved {
            resolved = fixpoint.transfers;
        } else {
            return Ok(Resolved {
                flow,
                fixpoint,
                changed,
                set_limit,
            });
        }
    }
}

/// An indirect branch with a target that is no code reads its table beyond the end: what it reaches
/// is not known, and the branch is where a fact helps.
fn blame_branch(
    program: &Program<'_>,
    resolved: &BTreeMap<Node, ControlTransfer>,
    error: Error,
) -> Error {
    let Error::NoCode(place) = &error else {
        return error;
    };
    let reaches = |transfer: &ControlTransfer| match transfer {
        ControlTransfer::Jump(nodes) => nodes.iter().any(|node| node.address == place.address),
        other => other
            .callees()
            .iter()
            .any(|(target, _)| *target == place.address),
    };
    let branch = resolved.iter().find(|(_, transfer)| reaches(transfer));
    branch.map_or(error, |(node, _)| {
        let called_from = Some(node.copy).filter(|site| *site != 0);
        Error::UnresolvedBranch(program.image.place(called_from.unwrap_or(node.address)))
    })
}

/// Functions called for the first time, each with a place where that happens.
fn new_callees(flow: &ControlFlowGraph, known: &BTreeMap<Entry, bool>) -> Vec<(Entry, u32)> {
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
pub fn summarise(program: &Program<'_>, entry: Entry) -> Result<FunctionSummary, Error> {
    let Resolved {
        flow,
        mut fixpoint,
        changed,
        set_limit,
    } = resolve_branches(program, entry)?;
    if program.facts.recursion(entry).is_some() && fixpoint.changed & !SCRATCH != 0 {
        return Err(Error::Recursion(vec![program.image.place(entry.0)]));
    }
    let block_count = flow.blocks.len();
    let places: Vec<u32> = flow.blocks.iter().map(|block| block.node.address).collect();
    let ReducibleGraph { flow, forest, .. } = reducible(flow).map_err(|block| {
        let place = places.get(block).copied().unwrap_or(entry.0);
        Error::Irreducible(program.image.place(place))
    })?;
    if flow.blocks.len() > block_count {
        fixpoint = fixpoint_of(program, &flow, &changed, entry, set_limit)?;
    }
    let numbers = program.facts.loop_numbers(&flow, &forest);
    Ok(FunctionSummary {
        states: fixpoint.states,
        returns: fixpoint.returns,
        changed: fixpoint.changed,
        callees: changed,
        ..FunctionSummary::of_graph(&program.facts, program.map, (flow, forest), numbers)?
    })
}

fn explore(
    program: &Program<'_>,
    entry: Entry,
    resolved: &BTreeMap<Node, ControlTransfer>,
    returning: &BTreeMap<Entry, bool>,
) -> Result<ControlFlowGraph, Error> {
    Explorer {
        image: program.image,
        entry,
        resolved,
        dead: &|address| program.facts.is_never_executed(address),
        returns: &|callee| returning.get(&callee).copied().unwrap_or(false),
        context_switches: &program.conventions.context_switches,
    }
    .explore()
}

/// States at all blocks for any arguments, and from them the targets of indirect branches. Sets of
/// up to `set_limit` elements may grow.
fn fixpoint_of(
    program: &Program<'_>,
    flow: &ControlFlowGraph,
    changed: &BTreeMap<Entry, u16>,
    entry: Entry,
    set_limit: usize,
) -> Result<Fixpoint, Error> {
    let mut interpreter = BlockInterpreter::new(program.environment(), flow, changed);
    let mut states: Vec<Option<State>> = vec![None; flow.blocks.len()];
    let mut visits = vec![0_u32; flow.blocks.len()];
    states[0] = Some(State::entry(&any_arguments()));
    let mut pending = BTreeSet::from([0]);
    let mut fixpoint = Fixpoint {
        states: Vec::new(),
        transfers: BTreeMap::new(),
        changed: 0,
        returns: false,
    };
    while let Some(index) = pending.pop_first() {
        let Some(state) = states[index].clone() else {
            continue;
        };
        let outcome = interpreter.run(index, state);
        resolve_branch(
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
                Some(old) if visits[next] < WIDENING_DELAY => old.join(&state),
                Some(old) => {
                    old.widen(&state, set_limit, |value| program.map.pointer_region(value))
                }
            };
            if states[next].as_ref() != Some(&merged) {
                visits[next] += 1;
                states[next] = Some(merged);
                pending.insert(next);
            }
        }
    }
    program.note_steps(interpreter.step_count);
    fixpoint.states = states;
    Ok(fixpoint)
}

fn check_return(
    program: &Program<'_>,
    flow: &ControlFlowGraph,
    index: usize,
    state: &State,
) -> Result<(), Error> {
    let block = &flow.blocks[index];
    let address = block
        .instructions
        .last()
        .map_or(block.node.address, |(a, _)| *a);
    if state.registers[13] == Value::Stack(0) || program.facts.leaves(address) {
        return Ok(());
    }
    Err(Error::StackNotRestored(program.image.place(address)))
}

/// Notes the transfer that the value of r15 at the end of a block means.
fn resolve_branch(
    program: &Program<'_>,
    flow: &ControlFlowGraph,
    entry: Entry,
    index: usize,
    outcome: &BlockOutcome,
    transfers: &mut BTreeMap<Node, ControlTransfer>,
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
    let depends_on_values = match block.transfer {
        Some(ControlTransfer::Unresolved) => true,
        Some(ControlTransfer::TailCall(_) | ControlTransfer::CallFor(..)) => block.node.copy != 0,
        _ => false,
    };
    if direct && !depends_on_values && !context_switches(program, block) {
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
    let known = value.elements().map(|elements| {
        let targets = elements.iter().map(|target| {
            let thumb = if exchanges {
                target & 1 != 0
            } else {
                node.thumb
            };
            (target & if thumb { !1 } else { !3 }, thumb)
        });
        targets.collect::<Vec<Entry>>()
    });
    let caller = Some(node.copy).filter(|site| *site != 0);
    let of_caller = || program.facts.call_targets(caller?);
    let fact = || of_caller().or_else(|| program.facts.call_targets(*address));
    // A table that is read beyond its end: a fact about its targets says more.
    let is_code = |(target, thumb): &Entry| program.image.instruction(*target, *thumb).is_some();
    let known = known.filter(|targets| targets.iter().all(is_code) || fact().is_none());
    let transfer = if *value == Value::entry(14) {
        ControlTransfer::Return
    } else if let Some(targets) = known {
        classify(program, entry, node, targets, calls)
    } else {
        match fact() {
            Some(targets) if calls => ControlTransfer::Call(targets),
            _ if program.facts.leaves(*address) => ControlTransfer::Return,
            Some(targets) => ControlTransfer::TailCall(targets),
            None => ControlTransfer::Unresolved,
        }
    };
    let link = link.filter(|_| node.copy != 0);
    transfers.insert(node, on_behalf_of_caller(transfer, link));
}

/// A local subroutine that leaves the function with a link into it comes back there.
fn on_behalf_of_caller(transfer: ControlTransfer, link: Option<u32>) -> ControlTransfer {
    match (transfer, link) {
        (ControlTransfer::TailCall(targets), Some(link)) => {
            let back = Node {
                copy: 0,
                address: link & !1,
                thumb: link & 1 != 0,
            };
            ControlTransfer::CallFor(targets, back)
        }
        (transfer, _) => transfer,
    }
}

/// A branch that stays unresolved, or becomes so when what it leads to is known.
fn unresolved(
    transfers: &BTreeMap<Node, ControlTransfer>,
    before: &BTreeMap<Node, ControlTransfer>,
) -> Option<Node> {
    let unknown = transfers.iter().find(|(node, transfer)| {
        **transfer == ControlTransfer::Unresolved && before.contains_key(*node)
    });
    unknown.map(|(node, _)| *node)
}

/// Is the branch at the end of a block to a function that takes the processor?
fn context_switches(program: &Program<'_>, block: &Block) -> bool {
    let Some((address, instruction)) = block.instructions.last() else {
        return false;
    };
    let Operation::Branch { offset, .. } = instruction.operation else {
        return false;
    };
    let target = address
        .wrapping_add(2 * instruction.size)
        .wrapping_add(offset);
    program.conventions.context_switches.contains(&target)
}

fn classify(
    program: &Program<'_>,
    entry: Entry,
    node: Node,
    targets: Vec<Entry>,
    calls: bool,
) -> ControlTransfer {
    if calls {
        return ControlTransfer::Call(targets);
    }
    let function = |target: &Entry| *target != entry && program.image.starts_function(target.0);
    if targets.iter().all(function) {
        return ControlTransfer::TailCall(targets);
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
    ControlTransfer::Jump(nodes.collect())
}

/// Back from a switch helper or a local subroutine to the code that called it.
fn returns_from_copy(program: &Program<'_>, node: Node, target: u32) -> bool {
    let size = if node.thumb { 2 } else { 4 };
    target == node.copy.wrapping_add(size)
        || program.image.names_at(target) != program.image.names_at(node.address)
}
