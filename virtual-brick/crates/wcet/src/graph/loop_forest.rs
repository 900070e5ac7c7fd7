// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Natural loops of a reducible graph and their nesting.

use crate::graph::control_flow::{ControlFlowGraph, Target};
use std::collections::BTreeSet;

/// A natural loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loop {
    /// Its only entry.
    pub header: usize,
    /// All its blocks.
    pub blocks: BTreeSet<usize>,
    /// Blocks with an edge back to the header.
    pub latches: BTreeSet<usize>,
    /// The next larger loop around it.
    pub parent: Option<usize>,
    /// Number of edges that leave it.
    pub exit_count: usize,
}

/// Loops, and the order in which blocks can be visited.
#[derive(Clone, Debug, Default)]
pub struct LoopForest {
    /// By address of the header.
    pub loops: Vec<Loop>,
    /// Reverse postorder; back edges aside, each block comes after its predecessors.
    pub order: Vec<usize>,
    /// Innermost loop of each block.
    pub innermost: Vec<Option<usize>>,
    /// What is visited in the function itself, then in each loop.
    scopes: Vec<Vec<Item>>,
}

/// Successors of a block within the function.
pub fn successors(flow: &ControlFlowGraph, block: usize) -> impl Iterator<Item = usize> + '_ {
    flow.blocks[block]
        .edges
        .iter()
        .filter_map(|edge| match edge.target {
            Target::Block(next) => Some(next),
            Target::Return => None,
        })
}

fn reverse_postorder(flow: &ControlFlowGraph) -> Vec<usize> {
    let mut order = Vec::new();
    let mut seen = vec![false; flow.blocks.len()];
    let mut stack = vec![(0, successors(flow, 0).collect::<Vec<_>>())];
    seen[0] = true;
    while let Some((block, open)) = stack.last_mut() {
        match open.pop() {
            Some(next) if !seen[next] => {
                seen[next] = true;
                stack.push((next, successors(flow, next).collect()));
            }
            Some(_) => {}
            None => {
                order.push(*block);
                stack.pop();
            }
        }
    }
    order.reverse();
    order
}

/// Immediate dominators by repeated intersection in reverse postorder.
fn dominators(flow: &ControlFlowGraph, order: &[usize]) -> Vec<usize> {
    let count = flow.blocks.len();
    let mut position = vec![usize::MAX; count];
    for (index, block) in order.iter().enumerate() {
        position[*block] = index;
    }
    let mut predecessors = vec![Vec::new(); count];
    for block in order {
        for next in successors(flow, *block) {
            predecessors[next].push(*block);
        }
    }
    let mut dominator = vec![usize::MAX; count];
    dominator[0] = 0;
    let mut changed = true;
    while changed {
        changed = false;
        for block in order.iter().copied().skip(1) {
            let known = predecessors[block]
                .iter()
                .filter(|p| dominator[**p] != usize::MAX);
            let common = known.copied().reduce(|mut a, mut b| {
                while a != b {
                    if position[a] > position[b] {
                        a = dominator[a];
                    } else {
                        b = dominator[b];
                    }
                }
                a
            });
            if let Some(common) = common.filter(|common| dominator[block] != *common) {
                dominator[block] = common;
                changed = true;
            }
        }
    }
    dominator
}

fn dominates(dominator: &[usize], above: usize, mut block: usize) -> bool {
    while block != above && block != 0 {
        block = dominator[block];
    }
    block == above
}

impl LoopForest {
    /// Finds the loops. `Err` is a block at which a loop is entered besides its header.
    pub fn new(flow: &ControlFlowGraph) -> Result<Self, usize> {
        let order = reverse_postorder(flow);
        let dominator = dominators(flow, &order);
        let mut position = vec![usize::MAX; flow.blocks.len()];
        for (index, block) in order.iter().enumerate() {
            position[*block] = index;
        }
        let mut loops: Vec<Loop> = Vec::new();
        for block in order.iter().copied() {
            for next in successors(flow, block).filter(|next| position[*next] <= position[block]) {
                if !dominates(&dominator, next, block) {
                    return Err(next);
                }
                add_back_edge(flow, &order, &mut loops, block, next);
            }
        }
        loops.sort_by_key(|found| flow.blocks[found.header].node);
        let mut forest = Self {
            innermost: vec![None; flow.blocks.len()],
            loops,
            order,
            scopes: Vec::new(),
        };
        forest.nest();
        forest.count_exits(flow);
        let scopes = std::iter::once(None).chain((0..forest.loops.len()).map(Some));
        forest.scopes = scopes.map(|scope| forest.items(scope)).collect();
        Ok(forest)
    }

    fn count_exits(&mut self, flow: &ControlFlowGraph) {
        for found in &mut self.loops {
            let edges = found.blocks.iter().flat_map(|b| &flow.blocks[*b].edges);
            let leaving = edges.filter(|edge| match edge.target {
                Target::Block(next) => !found.blocks.contains(&next),
                Target::Return => true,
            });
            found.exit_count = leaving.count();
        }
    }

    fn nest(&mut self) {
        let mut by_size: Vec<usize> = (0..self.loops.len()).collect();
        by_size.sort_by_key(|index| std::cmp::Reverse(self.loops[*index].blocks.len()));
        for index in by_size {
            let header = self.loops[index].header;
            self.loops[index].parent = self.innermost[header];
            for block in self.loops[index].blocks.clone() {
                self.innermost[block] = Some(index);
            }
        }
    }

    /// Is `block` in the scope: a loop, or with `None` the whole function?
    pub fn contains(&self, scope: Option<usize>, block: usize) -> bool {
        scope.is_none_or(|index| self.loops[index].blocks.contains(&block))
    }

    /// The blocks of a scope in order, those of inner loops represented by their headers.
    pub fn steps(&self, scope: Option<usize>) -> impl Iterator<Item = Item> + '_ {
        let items = self.scopes.get(scope.map_or(0, |index| index + 1));
        items.into_iter().flatten().copied()
    }

    fn items(&self, scope: Option<usize>) -> Vec<Item> {
        let item = |block: &usize| {
            if self.innermost[*block] == scope {
                return Some(Item::Block(*block));
            }
            let index = self.innermost[*block]?;
            let found = &self.loops[index];
            (found.header == *block && found.parent == scope).then_some(Item::Loop(index))
        };
        self.order.iter().filter_map(item).collect()
    }
}

/// One thing to visit in a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// A block of the scope itself.
    Block(usize),
    /// A loop directly inside.
    Loop(usize),
}

fn add_back_edge(
    flow: &ControlFlowGraph,
    order: &[usize],
    loops: &mut Vec<Loop>,
    latch: usize,
    header: usize,
) {
    let index = loops.iter().position(|found| found.header == header);
    let index = index.unwrap_or_else(|| {
        loops.push(Loop {
            header,
            blocks: BTreeSet::from([header]),
            latches: BTreeSet::new(),
            parent: None,
            exit_count: 0,
        });
        loops.len() - 1
    });
    loops[index].latches.insert(latch);
    let mut open = vec![latch];
    while let Some(block) = open.pop() {
        if loops[index].blocks.insert(block) {
            let before = order.iter().copied();
            open.extend(before.filter(|p| successors(flow, *p).any(|next| next == block)));
        }
    }
}
