//! A long array in pieces, borrowed where it lies: a groom is many small tufts in memory, and a
//! writer walks them in order without gluing them together first.
//!
//! The order of values is the order of the pieces. Empty pieces are allowed and mean nothing.

use std::borrow::Cow;

/// An array given as a list of slices, each borrowed or owned.
#[derive(Clone, Debug)]
pub struct Chunks<'a, T: Clone> {
    slices: Vec<Cow<'a, [T]>>,
}

impl<'a, T: Clone> Chunks<'a, T> {
    /// An array of no values.
    pub fn new() -> Self {
        Self { slices: Vec::new() }
    }

    /// Appends a slice (borrowed) or a vector (owned).
    pub fn push(&mut self, slice: impl Into<Cow<'a, [T]>>) {
        self.slices.push(slice.into());
    }

    /// Number of values, over all pieces.
    pub fn len(&self) -> usize {
        self.slices.iter().map(|slice| slice.len()).sum()
    }

    /// True when there is no value, however many empty pieces there are.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pieces in order.
    pub fn slices(&self) -> impl Iterator<Item = &[T]> {
        self.slices.iter().map(|slice| slice.as_ref())
    }

    /// The values in order.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.slices.iter().flat_map(|slice| slice.iter())
    }
}

impl<T: Clone> Default for Chunks<'_, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Clone> From<Vec<T>> for Chunks<'_, T> {
    fn from(values: Vec<T>) -> Self {
        Self { slices: vec![Cow::Owned(values)] }
    }
}

impl<'a, T: Clone> From<&'a [T]> for Chunks<'a, T> {
    fn from(values: &'a [T]) -> Self {
        Self { slices: vec![Cow::Borrowed(values)] }
    }
}

impl<'a, T: Clone> FromIterator<&'a [T]> for Chunks<'a, T> {
    fn from_iter<I: IntoIterator<Item = &'a [T]>>(slices: I) -> Self {
        Self { slices: slices.into_iter().map(Cow::Borrowed).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_read_as_one_array() {
        let tufts = [vec![1, 2], vec![], vec![3]];
        let array: Chunks<i32> = tufts.iter().map(Vec::as_slice).collect();
        assert_eq!(array.len(), 3);
        assert_eq!(array.values().copied().collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(array.slices().count(), 3);
    }
}
