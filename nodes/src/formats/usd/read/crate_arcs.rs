//! What prim specs of crate files bring in: lists of references, payloads and classes, selected variants, sublayers.
//!
//! A list is a byte of flags, then for each flag a count and its items. An asset is the number of a string, a path that of a path.
//! Every item is charged for.

use super::super::super::FormatError;
use super::super::coding::{INLINED, kind};
use super::crate_file::{CrateFile, Cursor};
use super::tree::{Arc, Edit, ListEdit, Target};

/// How the lists of a list edit follow each other, with their flags.
const LISTS: [(u8, Edit); 6] = [
    (1 << 1, Edit::Explicit),
    (1 << 2, Edit::Add),
    (1 << 5, Edit::Prepend),
    (1 << 6, Edit::Append),
    (1 << 3, Edit::Delete),
    (1 << 4, Edit::Reorder),
];
/// Flag of a list edit: the explicit list counts, be it empty.
const IS_EXPLICIT: u8 = 1;

impl CrateFile<'_, '_> {
    /// The edits of arcs of a kind.
    pub(super) fn arcs(&mut self, arc: Arc, value: u64) -> Result<Vec<ListEdit>, FormatError> {
        let number = (value >> 48) as u8;
        if value & INLINED != 0 {
            return Ok(Vec::new());
        }
        let mut cursor = self.at(value);
        let item = match number {
            kind::REFERENCE_LIST_OP => Self::reference,
            kind::PAYLOAD_LIST_OP => Self::payload,
            kind::PATH_LIST_OP => Self::class,
            kind::ONE_PAYLOAD => {
                let targets = vec![self.payload(&mut cursor)?];
                return Ok(vec![ListEdit { arc, edit: Edit::Explicit, targets }]);
            }
            _ => return Ok(Vec::new()),
        };
        let flags: u8 = cursor.number()?;
        let mut edits = Vec::new();
        for (flag, edit) in LISTS {
            let is_emptied = edit == Edit::Explicit && flags & IS_EXPLICIT != 0;
            if flags & flag == 0 && !is_emptied {
                continue;
            }
            let count = if flags & flag == 0 { 0 } else { cursor.u64()? };
            let mut targets = Vec::new();
            for _ in 0..count {
                let target = item(self, &mut cursor)?;
                self.budget.push(&mut targets, target)?;
            }
            self.budget.push(&mut edits, ListEdit { arc, edit, targets })?;
        }
        Ok(edits)
    }

    fn class(&mut self, cursor: &mut Cursor) -> Result<Target, FormatError> {
        let path = self.path_text(cursor.number()?)?;
        Ok(Target { asset: String::new(), path })
    }

    fn reference(&mut self, cursor: &mut Cursor) -> Result<Target, FormatError> {
        let target = self.asset_and_path(cursor)?;
        cursor.take(16)?; // offset and scale of time
        for _ in 0..cursor.u64()? {
            cursor.take(4)?; // a key of custom data
            cursor.jump()?;
            cursor.take(8)?;
        }
        Ok(target)
    }

    fn payload(&mut self, cursor: &mut Cursor) -> Result<Target, FormatError> {
        let target = self.asset_and_path(cursor)?;
        if self.minor >= 8 {
            cursor.take(16)?;
        }
        Ok(target)
    }

    fn asset_and_path(&mut self, cursor: &mut Cursor) -> Result<Target, FormatError> {
        let (asset, path): (u32, u32) = (cursor.number()?, cursor.number()?);
        let asset = self.string(asset)?.to_owned();
        self.budget.charge(asset.len() as u64)?;
        Ok(Target { asset, path: self.path_text(path)? })
    }

    /// Sets and names of selected variants.
    pub(super) fn selections(&mut self, value: u64) -> Result<Vec<[String; 2]>, FormatError> {
        if (value >> 48) as u8 != kind::VARIANT_SELECTION_MAP || value & INLINED != 0 {
            return Ok(Vec::new());
        }
        let mut cursor = self.at(value);
        let mut selections = Vec::new();
        for _ in 0..cursor.u64()? {
            let pair: [u32; 2] = cursor.number()?;
            let texts = self.copied(&pair, Self::string)?;
            if let Ok(pair) = <[String; 2]>::try_from(texts) {
                self.budget.push(&mut selections, pair)?;
            }
        }
        Ok(selections)
    }

    /// The assets of sublayers.
    pub(super) fn sub_layers(&mut self, value: u64) -> Result<Vec<String>, FormatError> {
        if (value >> 48) as u8 != kind::STRING_VECTOR || value & INLINED != 0 {
            return Ok(Vec::new());
        }
        let mut cursor = self.at(value);
        let count = cursor.u64()?;
        let strings: Vec<u32> = self.pod(&mut cursor, count)?;
        self.copied(&strings, Self::string)
    }
}
