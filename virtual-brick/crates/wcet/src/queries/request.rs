// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Several questions about one program, and their answers, for other programs.

use crate::error::{Error, Place};
use crate::functions::effects::{collect_functions, effects, stack_of, Effects, Endless};
use crate::functions::endless_loop::endless_loop;
use crate::functions::function_bound::FunctionBound;
use crate::functions::program::Program;
use crate::inputs::annotations::{Annotations, Fact};
use crate::inputs::image::{Entry, Image};
use crate::inputs::memory_map::MemoryMap;
use crate::queries::between_waits::outside_of_jobs;
use crate::queries::flow_points::{counted_facts, CountedFact};
use crate::queries::known_memory::{KnownMemory, LineCount};
use crate::queries::observed_path::observed_path;
use crate::queries::path_problem::PathGraph;
use crate::queries::path_report::PathReport;
use crate::queries::report::Report;
use crate::queries::task_job::{bound_job, JobBound, Task, TaskBody};
use crate::queries::unmatched_facts::{unmatched_facts, UnmatchedFact};
use crate::values::block_interpreter::BlockInterpreter;
use crate::values::value::Value;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// An annotation file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnnotationFile {
    /// For messages.
    pub name: String,
    /// TOML.
    pub text: String,
    /// Written for this program: facts that match nothing are reported.
    #[serde(default)]
    pub own: bool,
}

/// All questions.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Request {
    /// Facts about the program.
    pub annotations: Vec<AnnotationFile>,
    /// Functions to bound.
    pub functions: Vec<String>,
    /// Tasks to bound.
    pub jobs: Vec<Task>,
    /// Tasks of which the longest time between two waits is wanted that is none of their jobs.
    pub outside: Vec<Task>,
    /// Where code lies that is outside of these jobs.
    pub outside_places: Vec<Fact>,
    /// Functions that run in the background and need not end: only their effects on others.
    pub background: Vec<String>,
    /// Functions of which only the stack is wanted, whatever time they take.
    pub stacks: Vec<String>,
    /// Function from which calls are searched.
    pub root: Option<String>,
    /// Functions whose arguments at calls are wanted.
    pub callees: Vec<String>,
    /// Graphs are wanted too.
    pub graphs: bool,
    /// Worst paths of functions and jobs are wanted too.
    pub paths: bool,
    /// Beginnings of names of functions: for each, the longest time from a call of such a function
    /// to the end of the caller is wanted too.
    pub requesting: Vec<String>,
    /// Runs whose paths are wanted in the form of worst paths: address and cycles of each
    /// instruction.
    pub runs: Vec<Vec<(u32, u64)>>,
    /// Functions for which, with all that they call, the points are wanted at which a run shows
    /// whether facts hold.
    pub counted: Vec<String>,
    /// Calls that nothing disturbs, to bound as they are.
    pub known_memory: Option<KnownMemory>,
}

/// A loop that needs a bound.
#[derive(Clone, Debug, Serialize)]
pub struct MissingLoopBound {
    /// Function.
    pub symbol: String,
    /// Number in it.
    pub index: usize,
    /// File and line of its first instruction, empty when not known.
    pub line: String,
    /// Lines of all its blocks that are in no inner loop.
    pub lines: Vec<(String, u32)>,
    /// Functions through which it is reached, the outermost first.
    pub callers: Vec<String>,
}

/// Bounds of a function or a job, or why there are none.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answer {
    /// What was asked for.
    pub symbol: String,
    /// Why there is no bound.
    pub error: Option<String>,
    /// Loops that need a bound.
    pub missing: Vec<MissingLoopBound>,
    /// Cycles, without the fetches after the return.
    pub cycles: u64,
    /// Stack with all callees.
    pub stack_bytes: Option<u32>,
    /// Without it, file and line at which the depth of the stack is lost; empty when not known.
    pub stack_lost: Option<String>,
    /// Longest critical sections: urgency, cycles.
    pub critical_sections: Vec<(u32, u64)>,
    /// For each of the wanted beginnings, cycles from a call to the end; none where none is called.
    pub remaining: Vec<Option<u64>>,
    /// All functions that may be executed.
    pub reached: Vec<String>,
    /// Those of a job without the calls in which the task waits for its next release.
    pub reached_inside: Vec<String>,
    /// How the bound comes about.
    pub report: Option<Report>,
    /// Functions in which a task waits for its next release.
    pub released_by: Vec<String>,
    /// File and line where a task can stay for ever in a loop without a wait, or where what runs
    /// in the background stays, which never returns. A task's effects are those of the background.
    pub endless: Option<String>,
    /// The graph of which the longest path is a path, if requested.
    pub graph: Option<PathGraph>,
    /// The worst path by source lines, if requested.
    pub path: Option<PathReport>,
    /// AnnotationFile lines executed by a call that nothing disturbs.
    pub lines: Vec<LineCount>,
}

/// Arguments at one call.
#[derive(Clone, Debug, Serialize)]
pub struct Call {
    /// Called function.
    pub callee: String,
    /// Calling function.
    pub caller: String,
    /// r0 to r3 where they are constants.
    pub arguments: [Option<u32>; 4],
}

/// What the analysis of functions and jobs went through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Effort {
    /// Functions.
    pub functions: usize,
    /// Their blocks.
    pub blocks: usize,
    /// Their loops.
    pub loops: usize,
    /// Their instructions.
    pub instructions: usize,
    /// Instructions executed on abstract values.
    pub steps: u64,
}

impl Effort {
    fn of(program: &Program<'_>) -> Self {
        let mut effort = Self {
            steps: program.steps(),
            ..Self::default()
        };
        program.summaries(|summary| {
            let blocks = &summary.flow.blocks;
            effort.functions += 1;
            effort.blocks += blocks.len();
            effort.loops += summary.forest.loops.len();
            effort.instructions += blocks.iter().map(|b| b.instructions.len()).sum::<usize>();
        });
        effort
    }
}

/// All answers, in the order of the questions.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Response {
    /// What the times are of.
    pub timing: String,
    /// Most expensive fetches after a return.
    pub return_cycles: u64,
    /// Bounds of functions.
    pub functions: Vec<Answer>,
    /// Bounds of jobs.
    pub jobs: Vec<Answer>,
    /// Cycles between two waits outside of jobs; 0 if nothing is executed there.
    pub outside: Vec<Answer>,
    /// Effects of background functions, without cycles.
    pub background: Vec<Answer>,
    /// Stacks, without cycles.
    pub stacks: Vec<Answer>,
    /// Calls that were searched.
    pub calls: Vec<Call>,
    /// Bound of the last of the calls that nothing disturbs.
    pub known_memory: Option<Answer>,
    /// Paths of the runs.
    pub runs: Vec<PathReport>,
    /// Where facts are counted.
    pub counted: Vec<CountedFact>,
    /// Facts of the program's own files that match nothing.
    pub unmatched: Vec<UnmatchedFact>,
    /// Effort for `functions` and `jobs`.
    pub effort: Effort,
}

impl Answer {
    /// No bound.
    fn refused(program: &Program<'_>, symbol: &str, error: &Error) -> Self {
        let cut = match error {
            Error::NeverReturns(_) => program.facts.cutting_words(),
            _ => String::new(),
        };
        Self {
            symbol: symbol.to_owned(),
            error: Some(format!("{error}{cut}")),
            missing: missing_bounds(error),
            ..Self::default()
        }
    }

    /// A bound with its stack.
    fn bounded(
        program: &Program<'_>,
        symbol: &str,
        (bound, stack_bytes, stack_lost): (&FunctionBound, Option<u32>, Option<u32>),
        with_graph: bool,
    ) -> Self {
        let mut seen = BTreeSet::new();
        collect_functions(bound, &|_| false, &mut seen);
        Self {
            symbol: symbol.to_owned(),
            cycles: bound.cycles,
            stack_bytes,
            stack_lost: lost_at(program, stack_bytes, stack_lost),
            critical_sections: bound.sections.iter().map(|(u, c)| (*u, *c)).collect(),
            remaining: (0..)
                .zip(&program.requesting)
                .map(|(group, _)| bound.remaining.get(&group).copied())
                .collect(),
            reached: names(program, &seen),
            report: Some(Report::of_bound(program, symbol, bound, bound.cycles)),
            graph: with_graph.then(|| PathGraph::new(program, bound)),
            path: bound
                .path
                .as_ref()
                .map(|path| PathReport::new(program, path)),
            ..Self::default()
        }
    }

    /// A task's job.
    fn job(program: &Program<'_>, symbol: &str, job: &JobBound, with_graph: bool) -> Self {
        Self {
            reached: names(program, &job.reached),
            reached_inside: names(program, &job.inside),
            released_by: names(program, &job.waits),
            ..Self::bounded(
                program,
                symbol,
                (&*job.bound, job.stack_bytes, job.stack_lost),
                with_graph,
            )
        }
    }

    /// What runs in the background.
    fn background(program: &Program<'_>, symbol: &str) -> Self {
        let found = program.function(symbol).and_then(|entry| {
            let effects = effects(program, entry, Endless::Followed)?;
            Ok((effects, endless_loop(program, entry)?))
        });
        match found {
            Err(error) => Self::refused(program, symbol, &error),
            Ok((effects, endless)) => Self {
                endless: endless.as_ref().map(source_line),
                ..Self::of_effects(program, symbol, effects)
            },
        }
    }

    /// What a task executes outside of its jobs.
    fn outside(program: &Program<'_>, task: &Task, places: &[Fact]) -> Self {
        match outside_of_jobs(program, task, places) {
            Err(error) => Self::refused(program, &task.body, &error),
            Ok(cycles) => Self {
                symbol: task.body.clone(),
                cycles: cycles.unwrap_or(0),
                ..Self::default()
            },
        }
    }

    /// The stack alone.
    fn stack(program: &Program<'_>, symbol: &str) -> Self {
        let found = program.function(symbol);
        match found.and_then(|entry| stack_of(program, entry)) {
            Err(error) => Self::refused(program, symbol, &error),
            Ok(effects) => Self::of_effects(program, symbol, effects),
        }
    }

    fn of_effects(program: &Program<'_>, symbol: &str, found: Effects) -> Self {
        Self {
            symbol: symbol.to_owned(),
            stack_bytes: found.stack_bytes,
            stack_lost: lost_at(program, found.stack_bytes, found.stack_lost),
            critical_sections: found.sections.into_iter().collect(),
            reached: names(program, &found.functions),
            ..Self::default()
        }
    }
}

/// Where the depth of a stack without a bound is lost.
fn lost_at(program: &Program<'_>, bytes: Option<u32>, lost: Option<u32>) -> Option<String> {
    let place = lost.filter(|_| bytes.is_none());
    place.map(|address| source_line(&program.image.place(address)))
}

fn names(program: &Program<'_>, functions: &BTreeSet<u32>) -> Vec<String> {
    let addresses = functions.iter();
    addresses
        .map(|address| program.image.name_at(*address))
        .collect()
}

/// File and line, empty when not known.
fn source_line(place: &Place) -> String {
    let line = place.line.as_ref();
    line.map_or(String::new(), |(file, line)| format!("{file}:{line}"))
}

fn missing_bounds(error: &Error) -> Vec<MissingLoopBound> {
    let Error::MissingBounds(loops) = error else {
        return Vec::new();
    };
    let each = loops.iter().map(|found| {
        let symbol = found.place.symbol.as_ref().map_or("", |(name, _)| name);
        MissingLoopBound {
            symbol: symbol.to_owned(),
            index: found.index,
            line: source_line(&found.place),
            lines: found.lines.clone(),
            callers: found.callers.clone(),
        }
    });
    each.collect()
}

/// Calls of `callees` in everything that `root` calls.
fn calls(program: &Program<'_>, root: &str, callees: &[String]) -> Result<Vec<Call>, Error> {
    let wanted = callees.iter().filter_map(|c| program.image.function(c));
    let wanted: BTreeSet<Entry> = wanted.collect();
    let mut found = Vec::new();
    let mut open = vec![program.function(root)?];
    let mut seen: BTreeSet<Entry> = BTreeSet::new();
    while let Some(entry) = open.pop() {
        if !seen.insert(entry) {
            continue;
        }
        let summary = program.summary(entry, entry.0)?;
        let mut interpreter =
            BlockInterpreter::new(program.environment(), &summary.flow, &summary.callees);
        for (index, block) in summary.flow.blocks.iter().enumerate() {
            open.extend(&block.calls);
            let reached = block.calls.iter().find(|callee| wanted.contains(callee));
            let (Some(callee), Some(state)) = (reached, &summary.states[index]) else {
                continue;
            };
            interpreter.run(index, state.clone());
            let arguments = interpreter.records[index].arguments.as_ref();
            found.push(Call {
                callee: program.image.name_at(callee.0),
                caller: program.image.name_at(entry.0),
                arguments: std::array::from_fn(|n| arguments.and_then(|a| Value::constant(&a[n]))),
            });
        }
    }
    Ok(found)
}

fn path_of_run(program: &Program<'_>, steps: &[(u32, u64)]) -> PathReport {
    let tree = observed_path(program.image, program.map, steps);
    PathReport::new(program, &tree)
}

impl Request {
    /// The facts of all files, and those of the project's own that match nothing.
    fn annotations_for(&self, image: &Image) -> Result<(Annotations, Vec<UnmatchedFact>), Error> {
        let mut annotations = Annotations::default();
        let mut unmatched = Vec::new();
        for source in &self.annotations {
            let facts = Annotations::parse(&source.text, &source.name)?;
            if source.own {
                unmatched.extend(unmatched_facts(&facts, image));
            }
            annotations.extend(facts);
        }
        Ok((annotations, unmatched))
    }

    /// Stacks alone: how often a loop is executed does not matter.
    fn stacks(&self, known: &Program<'_>) -> Result<Vec<Answer>, Error> {
        let mut program = Program::new(known.image, known.map, known.facts.annotations)?;
        program.undecided_limit = 1;
        let stacks = self.stacks.iter();
        let found = stacks
            .map(|symbol| Answer::stack(&program, symbol))
            .collect();
        program.facts.check()?;
        Ok(found)
    }

    /// Answers all questions. An error is one of the image or of the annotations as a whole.
    pub fn answer(&self, elf: &[u8], map: &MemoryMap) -> Result<Response, Error> {
        let image = Image::read(elf)?;
        let (annotations, unmatched) = self.annotations_for(&image)?;
        let mut program = Program::new(&image, map, &annotations)?;
        program.paths_recorded = self.paths;
        program.requesting.clone_from(&self.requesting);
        let mut response = Response {
            timing: map.name.clone(),
            return_cycles: program.return_cycles()?,
            unmatched,
            ..Response::default()
        };
        for symbol in &self.functions {
            response.functions.push(match program.bound_of(symbol) {
                Err(error) => Answer::refused(&program, symbol, &error),
                Ok(found) => {
                    let bound = (&*found, found.stack_bytes, found.stack_lost);
                    Answer::bounded(&program, symbol, bound, self.graphs)
                }
            });
        }
        for task in &self.jobs {
            response.jobs.push(match bound_job(&program, task) {
                Err(error) => Answer::refused(&program, &task.body, &error),
                Ok(TaskBody::Jobs(job)) => Answer::job(&program, &task.body, &job, self.graphs),
                Ok(TaskBody::Endless(place)) => Answer {
                    endless: Some(source_line(&place)),
                    ..Answer::background(&program, &task.body)
                },
            });
        }
        let outside = self.outside.iter();
        response.outside = outside
            .map(|task| Answer::outside(&program, task, &self.outside_places))
            .collect();
        let background = self.background.iter();
        response.background = background
            .map(|symbol| Answer::background(&program, symbol))
            .collect();
        response.stacks = self.stacks(&program)?;
        if let Some(known_memory) = &self.known_memory {
            let symbol = known_memory.calls.last().cloned().unwrap_or_default();
            let found = known_memory.bound(&image, map, &annotations);
            response.known_memory = Some(match found {
                Err(error) => Answer::refused(&program, &symbol, &error),
                Ok(found) => Answer {
                    symbol,
                    cycles: found.cycles,
                    lines: found.lines,
                    ..Answer::default()
                },
            });
        }
        let runs = self.runs.iter();
        response.runs = runs.map(|steps| path_of_run(&program, steps)).collect();
        response.effort = Effort::of(&program);
        if !self.counted.is_empty() {
            response.counted = counted_facts(&program, &self.counted)?;
        }
        if let Some(root) = &self.root {
            response.calls = calls(&program, root, &self.callees)?;
        }
        program.facts.check()?;
        Ok(response)
    }
}
