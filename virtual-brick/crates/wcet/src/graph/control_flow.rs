// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Control-flow graph of one function: instructions reachable from its entry, cut into blocks.

use crate::error::Error;
use crate::inputs::image::{Entry, Image};
use arm7tdmi::instruction::{Instruction, Operation, ALWAYS};
use std::collections::{BTreeMap, BTreeSet};

/// An address and a state; `copy` is the call that a switch helper or a
/// local subroutine is copied for, otherwise 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node {
    /// See above.
    pub copy: u32,
    /// Address of the instruction.
    pub address: u32,
    /// Thumb state.
    pub thumb: bool,
}

/// Where an instruction that branches may lead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ControlTransfer {
    /// Within the function.
    Jump(Vec<Node>),
    /// Call, then the next instruction.
    Call(Vec<Entry>),
    /// Call by a local subroutine on behalf of the code that called it: where its return leads.
    CallFor(Vec<Entry>, Node),
    /// Call whose return is the function's own.
    TailCall(Vec<Entry>),
    /// The function's return.
    Return,
    /// Not known until the values are.
    Unresolved,
    /// Traps and places declared dead: no successor.
    Dead,
}

impl ControlTransfer {
    /// Functions that are called.
    pub fn callees(&self) -> &[Entry] {
        match self {
            Self::Call(callees) | Self::CallFor(callees, _) | Self::TailCall(callees) => callees,
            _ => &[],
        }
    }
}

/// Where an edge leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// To a block.
    Block(usize),
    /// Out of the function.
    Return,
}

/// An edge to a successor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The last instruction's condition passes on this edge.
    pub executed: bool,
    /// Where it leads.
    pub target: Target,
}

/// Instructions executed one after the other.
#[derive(Clone, Debug)]
pub struct Block {
    /// First instruction.
    pub node: Node,
    /// Addresses and instructions.
    pub instructions: Vec<(u32, Instruction)>,
    /// Functions called at the end.
    pub calls: Vec<Entry>,
    /// The last instruction is an indirect or direct transfer of this kind.
    pub transfer: Option<ControlTransfer>,
    /// Edges that leave it.
    pub edges: Vec<Edge>,
}

impl Block {
    /// Where the function goes on after the call at its end.
    pub fn resumes(&self) -> Option<Entry> {
        match (&self.transfer, self.instructions.last()) {
            (Some(ControlTransfer::Call(_)), Some((address, instruction))) => {
                Some((address.wrapping_add(instruction.size), self.node.thumb))
            }
            (Some(ControlTransfer::CallFor(_, back)), _) => Some((back.address, back.thumb)),
            _ => None,
        }
    }
}

/// The blocks of a function; the first is its entry.
#[derive(Clone, Debug, Default)]
pub struct ControlFlowGraph {
    /// In the order of their nodes, but the entry first.
    pub blocks: Vec<Block>,
}

/// What exploration needs besides the image.
pub struct Explorer<'a> {
    /// Code.
    pub image: &'a Image,
    /// The function's entry.
    pub entry: Entry,
    /// Transfers found by value analysis or by annotations.
    pub resolved: &'a BTreeMap<Node, ControlTransfer>,
    /// Places declared dead.
    pub dead: &'a dyn Fn(u32) -> bool,
    /// Does any path through this function return?
    pub returns: &'a dyn Fn(Entry) -> bool,
    /// Functions that take the processor from the thread which jumps to them.
    pub context_switches: &'a BTreeSet<u32>,
}

struct Explored {
    instruction: Instruction,
    transfer: Option<ControlTransfer>,
}

impl Node {
    fn after(self, size: u32) -> Self {
        Self {
            address: self.address.wrapping_add(size),
            ..self
        }
    }
}

/// Code that belongs to each of its calls: a switch helper of the compiler, or a veneer of the
/// linker, behind which a call reaches a function in the other state or far away.
pub fn is_helper(image: &Image, address: u32) -> bool {
    const VENEERS: [&str; 3] = ["_from_thumb", "_from_arm", "_veneer"];
    image.names_at(address).iter().any(|name| {
        let is_veneer = || VENEERS.iter().any(|end| name.ends_with(end));
        name.starts_with("__gnu_thumb1_case_") || name.starts_with("__") && is_veneer()
    })
}

impl Explorer<'_> {
    /// Direct transfer to an address: call, jump or tail call. What leaves a copy may do so on
    /// behalf of its caller, which the value of r14 tells.
    fn direct(&self, node: Node, target: Entry) -> ControlTransfer {
        if self.context_switches.contains(&target.0) {
            return ControlTransfer::Unresolved;
        }
        let function = target != self.entry && self.image.starts_function(target.0);
        if function && !is_helper(self.image, target.0) {
            return match node.copy {
                0 => ControlTransfer::TailCall(vec![target]),
                _ => ControlTransfer::Unresolved,
            };
        }
        ControlTransfer::Jump(vec![Node {
            copy: node.copy,
            address: target.0,
            thumb: target.1,
        }])
    }

    /// A call of a place within the function: a local subroutine, which may also return for the
    /// function itself, or in Thumb code a branch too far for B; and of a BX behind the functions
    /// of a file, with which Thumb code calls through a register; and of a helper. It is copied
    /// for each call.
    fn is_local(&self, site: u32, (target, thumb): Entry) -> bool {
        if is_helper(self.image, target) {
            return true;
        }
        if self.image.starts_function(target) {
            return false;
        }
        let names = self.image.names_at(target);
        let first = self.image.instruction(target, thumb).map(|i| i.operation);
        let calls = matches!(first, Some(Operation::BranchExchange { .. }));
        calls || !names.is_empty() && names == self.image.names_at(site)
    }

    /// The kind of an instruction that may leave the straight line.
    fn transfer(
        &self,
        node: Node,
        instruction: &Instruction,
    ) -> Result<Option<ControlTransfer>, Error> {
        let pc = node.address.wrapping_add(2 * instruction.size);
        Ok(Some(match &instruction.operation {
            Operation::Branch { offset, link } => {
                let target = (pc.wrapping_add(*offset), node.thumb);
                if *link && self.is_local(node.address, target) {
                    ControlTransfer::Jump(vec![Node {
                        copy: node.address,
                        address: target.0,
                        thumb: node.thumb,
                    }])
                } else if *link {
                    ControlTransfer::Call(vec![target])
                } else {
                    self.direct(node, target)
                }
            }
            Operation::LongBranchSuffix { offset } => {
                let before = node.address.wrapping_sub(2);
                let prefix = self.image.instruction(before, true).map(|i| i.operation);
                let Some(Operation::LongBranchPrefix { offset: upper }) = prefix else {
                    return Err(Error::NoCode(self.image.place(node.address)));
                };
                let target = pc.wrapping_sub(2).wrapping_add(upper).wrapping_add(*offset);
                if self.is_local(node.address, (target, true)) {
                    ControlTransfer::Jump(vec![Node {
                        copy: node.address,
                        address: target,
                        thumb: true,
                    }])
                } else {
                    ControlTransfer::Call(vec![(target, true)])
                }
            }
            Operation::SoftwareInterrupt => {
                return Err(Error::SoftwareInterrupt(self.image.place(node.address)))
            }
            Operation::Undefined => ControlTransfer::Dead,
            _ if instruction.cycles(Default::default()).refills > 0 => ControlTransfer::Unresolved,
            _ => return Ok(None),
        }))
    }

    fn visit(&self, node: Node) -> Result<Explored, Error> {
        let found = self.image.instruction(node.address, node.thumb);
        let instruction = found.ok_or_else(|| Error::NoCode(self.image.place(node.address)))?;
        let transfer = if (self.dead)(node.address) {
            Some(ControlTransfer::Dead)
        } else if let Some(known) = self.resolved.get(&node) {
            Some(known.clone())
        } else {
            self.transfer(node, &instruction)?
        };
        Ok(Explored {
            instruction,
            transfer,
        })
    }

    /// Successors, each with whether the condition passed.
    fn successors(&self, node: Node, explored: &Explored) -> Vec<(bool, Option<Node>)> {
        let next = node.after(explored.instruction.size);
        let mut successors = match &explored.transfer {
            None => return vec![(true, Some(next))],
            Some(ControlTransfer::Dead) => return Vec::new(),
            Some(ControlTransfer::Jump(targets)) => {
                targets.iter().map(|t| (true, Some(*t))).collect()
            }
            Some(ControlTransfer::Call(targets)) if targets.iter().any(|t| (self.returns)(*t)) => {
                vec![(true, Some(next))]
            }
            Some(ControlTransfer::CallFor(targets, back))
                if targets.iter().any(|t| (self.returns)(*t)) =>
            {
                vec![(true, Some(*back))]
            }
            Some(ControlTransfer::TailCall(targets))
                if targets.iter().any(|t| (self.returns)(*t)) =>
            {
                vec![(true, None)]
            }
            Some(ControlTransfer::Return) => vec![(true, None)],
            Some(_) => Vec::new(),
        };
        if explored.instruction.condition != ALWAYS {
            successors.push((false, Some(next)));
        }
        successors
    }

    /// All blocks reachable from the entry.
    pub fn explore(&self) -> Result<ControlFlowGraph, Error> {
        let entry = Node {
            copy: 0,
            address: self.entry.0,
            thumb: self.entry.1,
        };
        let mut seen: BTreeMap<Node, Explored> = BTreeMap::new();
        let mut leaders = BTreeSet::from([entry]);
        let mut open = vec![entry];
        let mut reached_from: BTreeMap<Node, usize> = BTreeMap::new();
        while let Some(node) = open.pop() {
            if seen.contains_key(&node) {
                continue;
            }
            let explored = self.visit(node)?;
            let successors = self.successors(node, &explored);
            for (_, successor) in &successors {
                let Some(next) = *successor else { continue };
                let count = reached_from.entry(next).or_default();
                *count += 1;
                if explored.transfer.is_some() || *count > 1 {
                    leaders.insert(next);
                }
                open.push(next);
            }
            seen.insert(node, explored);
        }
        Ok(self.cut(entry, &seen, &leaders))
    }

    fn cut(
        &self,
        entry: Node,
        seen: &BTreeMap<Node, Explored>,
        leaders: &BTreeSet<Node>,
    ) -> ControlFlowGraph {
        let mut order = vec![entry];
        order.extend(leaders.iter().copied().filter(|leader| *leader != entry));
        let index: BTreeMap<Node, usize> = order
            .iter()
            .enumerate()
            .map(|(i, node)| (*node, i))
            .collect();
        let blocks = order.iter().map(|leader| self.block(*leader, seen, &index));
        ControlFlowGraph {
            blocks: blocks.collect(),
        }
    }

    fn block(
        &self,
        leader: Node,
        seen: &BTreeMap<Node, Explored>,
        index: &BTreeMap<Node, usize>,
    ) -> Block {
        let mut block = Block {
            node: leader,
            instructions: Vec::new(),
            calls: Vec::new(),
            transfer: None,
            edges: Vec::new(),
        };
        let mut node = leader;
        while let Some(explored) = seen.get(&node) {
            block
                .instructions
                .push((node.address, explored.instruction));
            let next = node.after(explored.instruction.size);
            if explored.transfer.is_none() && !index.contains_key(&next) {
                node = next;
                continue;
            }
            if let Some(transfer) = &explored.transfer {
                block.calls.extend(transfer.callees());
            }
            block.transfer.clone_from(&explored.transfer);
            for (executed, successor) in self.successors(node, explored) {
                let target = successor.map_or(Some(Target::Return), |next| {
                    index.get(&next).map(|block| Target::Block(*block))
                });
                if let Some(target) = target {
                    block.edges.push(Edge { executed, target });
                }
            }
            break;
        }
        block
    }
}
