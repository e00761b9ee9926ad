//! How much a reader may allocate for a file: every allocation is charged before it is made.
//!
//! **Invariant:** what is charged stays below 32 MiB + 10 times the files that are read. Vectors that grow are
//! charged for their capacity; moving one to a larger place takes half as much again for a moment,
//! which keeps the real peak below 64 MiB + 20 times the files.

use super::super::super::FormatError;

/// Bytes that may still be allocated. What stays is never given back, so the budget bounds work too.
pub(in crate::formats) struct ReadBudget {
    left: u64,
}

impl ReadBudget {
    /// The budget for a file of so many bytes.
    pub(in crate::formats) fn for_file(length: usize) -> Self {
        Self { left: (32 << 20) + 10 * length as u64 }
    }

    /// A budget of so many bytes.
    pub(in crate::formats) fn of(bytes: u64) -> Self {
        Self { left: bytes }
    }

    /// For what following arcs takes, which is gone in the end: no file needs so much, however many prims it brings in.
    pub(super) fn for_arcs(length: usize) -> Self {
        Self { left: (128 << 20) + 4 * length as u64 }
    }

    /// Adds what another file of so many bytes may take.
    pub(super) fn allow_for_file(&mut self, length: usize) {
        self.left += 10 * length as u64;
    }

    /// Takes bytes from the budget.
    pub(in crate::formats) fn charge(&mut self, bytes: u64) -> Result<(), FormatError> {
        match self.left.checked_sub(bytes) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(FormatError::at(
                "file",
                "it unfolds to far more than its length, which no groom does: refused",
            )),
        }
    }

    /// Gives back what was charged for memory that is free again. Only for what was a step on the way
    /// to something that stays charged: a few tables must not be decoded without end.
    pub(in crate::formats) fn give_back(&mut self, bytes: u64) {
        self.left += bytes;
    }

    /// Takes the bytes of so many items.
    pub(in crate::formats) fn charge_items<T>(&mut self, count: u64) -> Result<(), FormatError> {
        self.charge(count.saturating_mul(size_of::<T>() as u64))
    }

    /// Appends to a vector, charging for its growth.
    pub(in crate::formats) fn push<T>(
        &mut self,
        values: &mut Vec<T>,
        value: T,
    ) -> Result<(), FormatError> {
        if values.len() == values.capacity() {
            let more = values.capacity().max(4);
            self.charge_items::<T>(more as u64)?;
            values.reserve_exact(more);
        }
        values.push(value);
        Ok(())
    }

    /// Copies a text, charging for it.
    pub(in crate::formats) fn text(&mut self, text: &str) -> Result<String, FormatError> {
        self.charge(text.len() as u64)?;
        Ok(text.to_owned())
    }
}
