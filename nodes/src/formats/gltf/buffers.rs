//! Buffers: the bytes accessors read, from the `.glb`, from base64 in the JSON or from a file beside
//! it. Only buffers that a mesh reads are opened.

use super::{Tables, whole_or};
use crate::data::mesh::MeshError;
use crate::formats::mesh_in::Side;
use crate::formats::mesh_in::limits::{Budget, excerpt};
use std::collections::BTreeMap;
use std::sync::Arc;

enum Bytes<'a> {
    Glb(&'a [u8]),
    Decoded(Vec<u8>),
    Side(Arc<[u8]>),
}

/// The buffers of a file that were needed so far.
pub(super) struct Buffers<'a> {
    bin: Option<&'a [u8]>,
    side: Side<'a>,
    open: BTreeMap<u32, Bytes<'a>>,
    /// By name, so that a file which many buffers name counts once.
    files: BTreeMap<String, Arc<[u8]>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(bin: Option<&'a [u8]>, side: Side<'a>) -> Self {
        Self { bin, side, open: BTreeMap::new(), files: BTreeMap::new() }
    }

    /// The bytes of a buffer that [`Self::open`] opened, as long as the file says it is.
    pub(super) fn get(&self, number: u32) -> Option<&[u8]> {
        Some(match self.open.get(&number)? {
            Bytes::Glb(bytes) => bytes,
            Bytes::Decoded(bytes) => bytes,
            Bytes::Side(bytes) => bytes,
        })
    }

    /// Opens a buffer that something at `from` names, unless it is open.
    pub(super) fn open(
        &mut self,
        tables: &Tables<'a>,
        number: u32,
        from: &str,
        budget: &mut Budget,
    ) -> Result<(), MeshError> {
        if self.open.contains_key(&number) {
            return Ok(());
        }
        let place = format!("buffers[{number}]");
        let buffer = tables.buffers.item(number, from)?;
        let stated = whole_or(buffer, "byteLength", None, &place)?;
        let uri = match buffer.get("uri") {
            None => None,
            Some(uri) => Some(uri.text().ok_or_else(|| {
                MeshError::at(format!("{place}.uri"), format!("{} is no text", uri.shown()))
            })?),
        };
        let bytes = match (uri, self.bin) {
            (Some(uri), _) if is_data(uri) => {
                budget.take(&place, uri.len() as u64)?;
                Bytes::Decoded(decode_data_uri(uri).map_err(|e| MeshError::at(&place, e))?)
            }
            (Some(uri), _) => {
                let name = side_name(uri).map_err(|e| MeshError::at(&place, e))?;
                Bytes::Side(self.file(name, &place, budget)?)
            }
            (None, Some(bin)) if number == 0 => Bytes::Glb(bin),
            (None, _) => {
                let compressed = buffer.get("extensions").and_then(|e| e.members().next());
                let reason = match compressed {
                    Some((name, _)) => {
                        format!(
                            "its bytes need the extension {}, not read",
                            excerpt(name.as_bytes())
                        )
                    }
                    None => "it has no bytes: neither a uri nor a binary chunk".to_owned(),
                };
                return Err(MeshError::at(place, reason));
            }
        };
        self.open.insert(number, bytes);
        let have = self.get(number).map_or(0, <[u8]>::len);
        if stated > have as u64 {
            let reason = format!("it should have {stated} bytes and has {have}");
            return Err(MeshError::at(place, reason));
        }
        Ok(())
    }

    fn file(
        &mut self,
        name: String,
        place: &str,
        budget: &mut Budget,
    ) -> Result<Arc<[u8]>, MeshError> {
        if let Some(bytes) = self.files.get(&name) {
            return Ok(bytes.clone());
        }
        let Some(bytes) = (self.side)(&name) else {
            let name = excerpt(name.as_bytes());
            return Err(MeshError::at(place, format!("the file `{name}` beside it is missing")));
        };
        budget.add_file(bytes.len());
        self.files.insert(name, bytes.clone());
        Ok(bytes)
    }
}

pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The relative file name a uri stands for, or why it stands for none we open: a scheme, an absolute
/// path, or a step up and out of the folder.
pub(super) fn side_name(uri: &str) -> Result<String, String> {
    let refuse = |why: &str| Err(format!("the uri `{}` {why}", excerpt(uri.as_bytes())));
    let mut name = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(b) = rest.next() {
        if b != b'%' {
            name.push(b);
            continue;
        }
        let digit = |b: Option<u8>| b.and_then(|b| char::from(b).to_digit(16));
        let (Some(high), Some(low)) = (digit(rest.next()), digit(rest.next())) else {
            return refuse("has a % without two hexadecimal digits");
        };
        name.push((16 * high + low) as u8);
    }
    let Ok(name) = String::from_utf8(name) else {
        return refuse("is not UTF-8");
    };
    if name.is_empty() {
        return refuse("is empty");
    }
    if name.contains(':') {
        return refuse("leads to another place than a file beside this one");
    }
    if name.starts_with('/') || name.contains('\\') {
        return refuse("is not a relative path with / between folders");
    }
    if name.chars().any(char::is_control) {
        return refuse("has control characters");
    }
    if name.split('/').any(|step| step == "..") {
        return refuse("leads out of the folder of this file");
    }
    let steps = name.split('/').filter(|step| !matches!(*step, "" | "."));
    let name = steps.collect::<Vec<_>>().join("/");
    if name.is_empty() { refuse("names no file") } else { Ok(name) }
}

/// The bytes of `data:...;base64,....`.
pub(super) fn decode_data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let Some((head, text)) = uri.split_once(',') else {
        return Err("its data uri has no comma before the data".to_owned());
    };
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Err("its data uri is not base64".to_owned());
    }
    let text = text.as_bytes();
    let digits = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    if digits.len() % 4 == 1 {
        return Err("its base64 data is cut off".to_owned());
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for (i, four) in digits.chunks(4).enumerate() {
        let mut bits = 0;
        for (j, b) in four.iter().enumerate() {
            let Some(digit) = base64_digit(*b) else {
                let at = 4 * i + j;
                return Err(format!("its base64 data has a wrong character at {at}"));
            };
            bits |= u32::from(digit) << (18 - 6 * j);
        }
        bytes.extend_from_slice(&bits.to_be_bytes()[1..four.len()]);
    }
    Ok(bytes)
}

fn base64_digit(b: u8) -> Option<u8> {
    Some(match b {
        b'A'..=b'Z' => b - b'A',
        b'a'..=b'z' => b - b'a' + 26,
        b'0'..=b'9' => b - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_decoded() {
        for (text, bytes) in [
            ("", "".as_bytes()),
            ("Zg==", b"f"),
            ("Zm8=", b"fo"),
            ("Zm9v", b"foo"),
            ("Zm9vYg", b"foob"),
            ("/+8A", b"\xff\xef\0"),
        ] {
            assert_eq!(decode_data_uri(&format!("data:;base64,{text}")).as_deref(), Ok(bytes));
        }
        for (uri, says) in [
            ("data:;base64", "its data uri has no comma before the data"),
            ("data:text/plain,hi", "its data uri is not base64"),
            ("data:;base64,AAAAA", "its base64 data is cut off"),
            ("data:;base64,AAAA AAA", "its base64 data has a wrong character at 4"),
        ] {
            assert_eq!(decode_data_uri(uri), Err(says.to_owned()));
        }
    }

    #[test]
    fn only_files_beside_or_below_are_named() {
        for (uri, name) in [
            ("a.bin", Some("a.bin")),
            ("./b//a%20b.bin", Some("b/a b.bin")),
            ("a..b", Some("a..b")),
            ("../a.bin", None),
            ("b/../../a", None),
            ("b/%2e%2E/a", None),
            ("/etc/passwd", None),
            ("..\\a", None),
            ("c:/a", None),
            ("http://a/b", None),
            ("file:a", None),
            ("%2fa", None),
            ("a%00b", None),
            ("a%4", None),
            ("%ff", None),
            ("", None),
            ("./", None),
        ] {
            assert_eq!(side_name(uri).ok().as_deref(), name, "{uri}");
        }
    }
}
