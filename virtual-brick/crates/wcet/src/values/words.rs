// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Words of the stack by their offset. There are few, and a state is copied for each edge, so they
//! are one sorted list: copies and passes over all of them are what takes time.

/// What is known of some words, in ascending order of their offsets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words<V>(Vec<(i32, V)>);

impl<V> Default for Words<V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<V> Words<V> {
    fn place(&self, offset: i32) -> Result<usize, usize> {
        self.0.binary_search_by_key(&offset, |(known, _)| *known)
    }

    /// What is known of a word.
    pub fn get(&self, offset: i32) -> Option<&V> {
        self.place(offset).ok().map(|index| &self.0[index].1)
    }

    /// All, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = (i32, &V)> {
        self.0.iter().map(|(offset, value)| (*offset, value))
    }

    /// What is known, of each.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut V> {
        self.0.iter_mut().map(|(_, value)| value)
    }

    /// In place of what was known before.
    pub fn insert(&mut self, offset: i32, value: V) {
        match self.place(offset) {
            Ok(index) => self.0[index].1 = value,
            Err(index) => self.0.insert(index, (offset, value)),
        }
    }

    /// Nothing is known of this word.
    pub fn remove(&mut self, offset: i32) {
        if let Ok(index) = self.place(offset) {
            self.0.remove(index);
        }
    }

    /// Forgets the others.
    pub fn retain(&mut self, mut keep: impl FnMut(i32, &V) -> bool) {
        self.0.retain(|(offset, value)| keep(*offset, value));
    }

    /// Counts offsets from a place that lies `by` higher.
    pub fn rebase(&mut self, by: i32) {
        for (offset, _) in &mut self.0 {
            *offset = offset.wrapping_sub(by);
        }
        self.0.sort_by_key(|(offset, _)| *offset);
    }

    /// Words that both have, with what `join` makes of them.
    pub fn common(&self, other: &Self, mut join: impl FnMut(&V, &V) -> Option<V>) -> Self {
        let mut others = other.0.iter().peekable();
        let both = self.0.iter().filter_map(|(offset, value)| {
            while others.next_if(|(known, _)| known < offset).is_some() {}
            let (_, theirs) = others.next_if(|(known, _)| known == offset)?;
            Some((*offset, join(value, theirs)?))
        });
        Self(both.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(list: &[(i32, u32)]) -> Words<u32> {
        let mut words = Words::default();
        for &(offset, value) in list {
            words.insert(offset, value);
        }
        words
    }

    fn list(words: &Words<u32>) -> Vec<(i32, u32)> {
        words
            .iter()
            .map(|(offset, value)| (offset, *value))
            .collect()
    }

    #[test]
    fn words_are_found_replaced_and_forgotten_by_their_offset() {
        let mut found = words(&[(4, 1), (-8, 2), (0, 3), (4, 5)]);
        assert_eq!(list(&found), [(-8, 2), (0, 3), (4, 5)]);
        assert_eq!((found.get(4), found.get(-4)), (Some(&5), None));
        found.remove(0);
        found.remove(12);
        found.retain(|offset, value| offset < 0 || *value != 5);
        assert_eq!(list(&found), [(-8, 2)]);
    }

    #[test]
    fn a_rebased_list_is_still_in_order_where_an_offset_wraps() {
        let mut found = words(&[(-8, 1), (i32::MIN, 2)]);
        found.rebase(4);
        assert_eq!(list(&found), [(-12, 1), (i32::MAX - 3, 2)]);
    }

    #[test]
    fn what_both_have_is_joined() {
        let (one, other) = (
            words(&[(-4, 1), (0, 2), (8, 3), (12, 4)]),
            words(&[(-8, 9), (0, 5), (8, 3), (16, 4)]),
        );
        let joined = one.common(&other, |a, b| (a == b).then_some(*a));
        assert_eq!(list(&joined), [(8, 3)]);
        let joined = other.common(&one, |a, b| Some(a + b));
        assert_eq!(list(&joined), [(0, 7), (8, 6)]);
    }
}
