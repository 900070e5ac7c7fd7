// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What decoding and compiling may cost: a fortieth of the time that passes without them, and what
//! they have saved. A program that never earns the cost of its blocks runs about as fast as with
//! single steps. A block may also be compiled when it has itself run for twice as long as that
//! takes, and as the compilation of code took that was invalidated before it had saved as much.
//!
//! Amounts are host time in units of about a quarter of a nanosecond, for blocks, and a sixteenth
//! of a nanosecond, for JIT code. They steer the speed only: a run is the same whatever is decoded
//! or compiled.

/// A fortieth of a step of the reference engine.
const STEP: i64 = 1;
/// A quarter of what a cycle in blocks saves, compared with single steps.
const BLOCK_CYCLE: i64 = 4;
/// What entering and leaving the blocks costs.
const BLOCKS_ENTRY: i64 = 60;
/// Decoding of one instruction, with the memory that it takes.
const DECODED_INSTRUCTION: i64 = 800;
/// Most that is kept, which is what a run begins with: programs execute thousands of instructions
/// once before they settle, and single steps would cost more than these blocks.
const DECODING_MAX: i64 = 10_000 * DECODED_INSTRUCTION;
/// After a refusal the blocks are not asked for so many steps.
const STEPS_WITHOUT_BLOCKS: u32 = 128;
/// In so many cycles in blocks, a unit is earned for compilation: a 256th of their time.
const CYCLES_PER_COMPILING: i64 = 16;
/// What a cycle in JIT code saves besides, compared with blocks.
const CODE_CYCLE: i64 = 12;
/// Compilation of a region, and of each of its instructions.
const COMPILED_REGION: i64 = 1_000_000;
const COMPILED_INSTRUCTION: i64 = 280_000;
/// Half of what a run of one interpreted instruction takes.
const INTERPRETED_INSTRUCTION: u64 = 16;
/// Most that is kept for compilation.
const COMPILING_MAX: i64 = 2_000 * COMPILED_INSTRUCTION;

/// The means of one run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    decoding: i64,
    compiling: i64,
    /// What compilation of the code that exists has cost.
    code: i64,
    /// Steps of the reference engine before blocks are asked again.
    steps_without_blocks: u32,
    /// Everything is decoded and compiled at once, in tests.
    unlimited: bool,
}

impl Budget {
    pub const fn new(unlimited: bool) -> Self {
        Self {
            decoding: DECODING_MAX,
            compiling: 0,
            code: 0,
            steps_without_blocks: 0,
            unlimited,
        }
    }

    /// Called after a run of blocks: the steps that the reference engine makes before the next.
    #[inline(always)]
    pub fn steps_of_reference(&mut self) -> u32 {
        self.decoding += STEP;
        std::mem::take(&mut self.steps_without_blocks)
    }

    /// Cycles that passed in blocks, once entered; and those of them that passed in JIT code,
    /// without as many as entering it costs.
    #[inline(always)]
    pub fn earn(&mut self, cycles: u64, code_gain_cycles: i64) {
        let decoding = self.decoding + cycles as i64 * BLOCK_CYCLE - BLOCKS_ENTRY;
        self.decoding = decoding.min(DECODING_MAX);
        let earned = cycles as i64 / CYCLES_PER_COMPILING + code_gain_cycles * CODE_CYCLE;
        self.compiling = (self.compiling + earned).min(COMPILING_MAX);
    }

    /// May blocks be decoded, or invalidated all at once? If not, not for some steps.
    pub fn affords_decoding(&mut self) -> bool {
        let affords = self.unlimited || self.decoding > 0;
        if !affords {
            let more = STEPS_WITHOUT_BLOCKS - self.steps_without_blocks;
            self.steps_without_blocks += more;
            self.decoding += i64::from(more) * STEP;
        }
        affords
    }

    /// So many instructions were decoded, or as much work was done.
    pub fn pay_for_decoding(&mut self, instructions: usize) {
        self.decoding -= instructions as i64 * DECODED_INSTRUCTION;
    }

    /// May a block of so many instructions be compiled, which has run so often?
    pub fn affords_compiling(&self, instructions: usize, runs: u64) -> bool {
        let own = runs * instructions as u64 * INTERPRETED_INSTRUCTION;
        let cost = compilation(instructions);
        let debt = (-self.compiling - self.code).max(0);
        self.unlimited || self.compiling >= cost || own as i64 >= cost + debt
    }

    pub fn pay_for_compiling(&mut self, instructions: usize) {
        self.compiling -= compilation(instructions);
        self.code += compilation(instructions);
    }

    /// The code of a region of so many instructions was invalidated.
    pub fn lose_code(&mut self, instructions: usize) {
        self.code -= compilation(instructions);
    }
}

const fn compilation(instructions: usize) -> i64 {
    COMPILED_REGION + instructions as i64 * COMPILED_INSTRUCTION
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decoding_pauses_when_it_has_cost_what_it_may() {
        let mut budget = Budget::new(false);
        assert!(budget.steps_of_reference() == 0 && budget.affords_decoding());
        budget.pay_for_decoding(10_001);
        assert!(!budget.affords_decoding());
        assert_eq!(budget.steps_of_reference(), STEPS_WITHOUT_BLOCKS);
        assert_eq!(budget.steps_of_reference(), 0);
        budget.earn(1_000, 0);
        assert!(budget.affords_decoding());
    }

    #[test]
    fn compilation_waits_for_a_share_of_the_run() {
        let mut budget = Budget::new(false);
        assert!(!budget.affords_compiling(1, 0));
        budget.earn((compilation(1) * CYCLES_PER_COMPILING) as u64, 0);
        assert!(budget.affords_compiling(1, 0) && !budget.affords_compiling(2, 0));
        budget.pay_for_compiling(1);
        assert!(!budget.affords_compiling(1, 0));
        assert!(budget.affords_compiling(1, 1_000_000));
        assert!(Budget::new(true).affords_compiling(1_000, 0));
    }

    #[test]
    fn compilation_waits_longer_where_code_is_invalidated() {
        let runs =
            |instructions| (compilation(instructions) as u64).div_ceil(INTERPRETED_INSTRUCTION);
        let mut budget = Budget::new(false);
        budget.pay_for_compiling(1_000);
        assert!(budget.affords_compiling(1, runs(1)));
        budget.lose_code(1_000);
        assert!(!budget.affords_compiling(1, runs(1)));
        assert!(budget.affords_compiling(1, runs(1) + runs(1_000)));
        budget.earn(0, compilation(1_000) / CODE_CYCLE + 1);
        assert!(budget.affords_compiling(1, runs(1)));
    }
}
