// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! What the loudspeaker would play: the levels of the sound line, averaged to samples.
//!
//! The amplifier behind the line is a low-pass filter; here it is the mean over one sample. A level
//! that the program sets by itself and keeps is silence: a loudspeaker plays changes.

use at91sam7s::board::{Cycles, SoundBits};

/// Length of a sample: 48,054.857 Hz.
pub const SAMPLE_CYCLES: Cycles = 1_000;
/// Samples kept at most, about 17 minutes of sound; later ones are lost.
const LIMIT: usize = 50_000_000;
/// Levels that the program keeps for longer are not heard: half a period of 25 Hz (chosen).
const LONGEST_LEVEL_CYCLES: Cycles = 20 * 48_055;

/// Samples without a gap, from a sample number on.
#[derive(Clone, Debug)]
struct Stretch {
    first: u64,
    samples: Vec<i16>,
}

/// Everything played so far.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    stretches: Vec<Stretch>,
    kept: usize,
    /// The sample that is being averaged, and its sum of bit durations, ones positive.
    current: u64,
    sum: i64,
    /// The level that the program drives, if it does, and since when.
    level: Option<bool>,
    level_since: Cycles,
}

impl Recording {
    /// Bits whose last one ended at `now`.
    pub fn add(&mut self, now: Cycles, sound: SoundBits) {
        let length = Cycles::from(sound.count) * sound.bit_cycles;
        let mut at = now.saturating_sub(length);
        for place in (0..sound.count).rev() {
            self.add_bit(at, at + sound.bit_cycles, sound.bits >> place & 1 != 0);
            at += sound.bit_cycles;
        }
    }

    /// The program drives the line at this level from `now` on; with `None` it does not.
    pub fn drive(&mut self, now: Cycles, level: Option<bool>) {
        if level == self.level {
            return;
        }
        let heard = self
            .level
            .filter(|_| now - self.level_since <= LONGEST_LEVEL_CYCLES);
        if let Some(high) = heard {
            self.add_bit(self.level_since, now, high);
        }
        (self.level, self.level_since) = (level, now);
    }

    fn add_bit(&mut self, start: Cycles, end: Cycles, high: bool) {
        let mut at = start;
        while at < end {
            let number = at / SAMPLE_CYCLES;
            if number != self.current {
                self.close(number);
            }
            let until = end.min((number + 1) * SAMPLE_CYCLES);
            let duration = (until - at) as i64;
            self.sum += if high { duration } else { -duration };
            at = until;
        }
    }

    fn close(&mut self, next: u64) {
        if self.sum != 0 {
            let full = i64::from(i16::MAX);
            let sample = (self.sum * full / SAMPLE_CYCLES as i64) as i16;
            self.keep(sample);
        }
        (self.current, self.sum) = (next, 0);
    }

    fn keep(&mut self, sample: i16) {
        if self.kept == LIMIT {
            return;
        }
        self.kept += 1;
        match self.stretches.last_mut() {
            Some(last) if last.first + last.samples.len() as u64 == self.current => {
                last.samples.push(sample);
            }
            _ => self.stretches.push(Stretch {
                first: self.current,
                samples: vec![sample],
            }),
        }
    }

    /// Samples `first` to before `end`, silence where nothing was played. The sample that is not
    /// complete counts as silence.
    pub fn samples(&self, first: u64, end: u64) -> Vec<i16> {
        let mut samples = vec![0; end.saturating_sub(first) as usize];
        for stretch in &self.stretches {
            let passed = first.saturating_sub(stretch.first);
            let rest = stretch.samples.get(passed as usize..).unwrap_or_default();
            for (number, sample) in (stretch.first + passed..).zip(rest) {
                let place = number.checked_sub(first).map(|place| place as usize);
                if let Some(slot) = place.and_then(|place| samples.get_mut(place)) {
                    *slot = *sample;
                }
            }
        }
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(bits: u32, bit_cycles: Cycles) -> SoundBits {
        SoundBits {
            bits,
            count: 32,
            bit_cycles,
        }
    }

    #[test]
    fn a_sample_is_the_mean_of_its_bits() {
        let mut recording = Recording::default();
        recording.add(3_200, word(0xFFFF_0000, 100));
        assert_eq!(recording.samples(0, 3), [32_767, 6_553, -32_767]);
    }

    #[test]
    fn a_program_that_changes_the_line_is_heard_until_it_keeps_the_level() {
        let mut recording = Recording::default();
        let mut heard = |changes: [(Cycles, Option<bool>); 4]| {
            for (at, level) in changes {
                recording.drive(at, level);
            }
            recording.samples(changes[0].0 / SAMPLE_CYCLES, changes[3].0 / SAMPLE_CYCLES)
        };
        let high_and_low = [(2_000, false), (5_000, true), (6_500, false), (8_500, true)];
        let samples = heard(high_and_low.map(|(at, level)| (at, Some(level))));
        assert_eq!(samples, [-32_767, -32_767, -32_767, 32_767, 0, -32_767]);
        let longest = LONGEST_LEVEL_CYCLES;
        let kept = [10_000_000, 10_000_000 + longest + 1, 20_000_000, 30_000_000];
        let samples = heard([
            (kept[0], Some(false)),
            (kept[1], Some(true)),
            (kept[2], None),
            (kept[3], Some(true)),
        ]);
        assert!(samples.iter().all(|sample| *sample == 0));
    }

    #[test]
    fn pauses_are_silent() {
        let mut recording = Recording::default();
        recording.add(3_200, word(u32::MAX, 100));
        recording.add(10_000, word(0, 50));
        recording.add(20_000, word(0, 50));
        let samples = recording.samples(0, 10);
        assert_eq!(samples[..4], [32_767, 32_767, 32_767, 6_553]);
        assert_eq!(samples[4..], [0, 0, 0, 0, -19_660, -32_767]);
        assert_eq!(recording.samples(2, 5), [32_767, 6_553, 0]);
    }
}
