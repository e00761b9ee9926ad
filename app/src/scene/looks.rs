//! The looks that heads bring along in their files: read from the disk for pictures alone, never for evaluation.
//!
//! Files are those that the mesh file names, beside it or below it, and no others. Guaranteed: what cannot be shown is a remark that
//! names file, material and picture, and the head has its skin tone there; all pictures of a file together hold at most
//! [`MOST_TEXELS`] pixels, larger ones are halved. Not promised: that a change on the disk is seen before the head changes or is
//! drawn anew.

use crate::files::read_at_most;
use crate::scene::Skin;
use coif_graphs::document::{Document, NodeId};
use coif_graphs::schedule::files::{self, path_of};
use coif_nodes::data::scalp::Scalp;
use coif_nodes::formats::looks::{self, Looks, Picture, read_looks};
use coif_shaders::maps::{Kind, Map, MaterialMaps, Texels};
use coif_shaders::surface::{Solid, head_solid, head_with_maps};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// The largest mesh file, and the largest file beside it.
const MOST_MESH: u64 = 2 << 30;
const MOST_SIDE: u64 = 512 << 20;
/// The most pixels of all pictures of a head: half a GiB.
const MOST_TEXELS: u64 = 1 << 27;
/// So many remarks are told.
const MOST_REMARKS: usize = 8;

/// The mesh file of a head, where it has one.
pub(crate) fn file_of(document: &Document, folder: &Path, node: &NodeId) -> Option<PathBuf> {
    let setting = document.node(node.as_str())?.inputs.get("mesh")?;
    Some(folder.join(&*path_of("mesh", setting)?))
}

/// What a mesh file says of its looks; no picture is decoded yet.
pub(crate) struct HeadLooks {
    file: PathBuf,
    looks: Looks,
    /// The files beside it that were read.
    pub(crate) beside: Vec<PathBuf>,
}

impl HeadLooks {
    /// Reads it; none where it is no mesh, which evaluation tells.
    pub(crate) fn read(file: &Path) -> Option<Self> {
        let bytes = read_at_most(file, MOST_MESH).ok()?;
        let extension = file.extension().unwrap_or_default().to_string_lossy();
        let folder = file.parent().unwrap_or(Path::new(""));
        let beside = RefCell::new(vec![]);
        let side = |name: &str| {
            let is_plain = Path::new(name).components().all(|c| matches!(c, Component::Normal(_)));
            let path = folder.join(name);
            let bytes = is_plain.then(|| read_at_most(&path, MOST_SIDE).ok()).flatten()?;
            beside.borrow_mut().push(path);
            Some(Arc::from(bytes))
        };
        let looks = read_looks(&extension, &bytes, &side).ok()?;
        let beside = beside.into_inner();
        Some(Self { file: file.to_owned(), looks, beside })
    }

    /// Decodes its pictures.
    pub(crate) fn decoded(mut self) -> FileLooks {
        let mut shown = Shown::default();
        let pictures = std::mem::take(&mut self.looks.pictures);
        let mut remarks = std::mem::take(&mut self.looks.remarks);
        let mut materials = vec![];
        for material in &self.looks.materials {
            let mut map = |map: &Option<looks::TextureMap>, kind, what: &str| {
                let map = map.as_ref()?;
                let picture = pictures.get(map.picture)?;
                let found = shown.picture(map.picture, picture, kind).and_then(|at| {
                    match map.doubtful && !shown.all[at].is_of_normals() {
                        true => {
                            Err("it holds heights, and only maps of normals are shown".to_owned())
                        }
                        false => Ok(at),
                    }
                });
                match found {
                    Ok(at) => Some((at, map.clone())),
                    Err(reason) => {
                        remarks.push(format!(
                            "material \"{}\": its {what} map {} is not shown: {reason}",
                            material.name, picture.name
                        ));
                        None
                    }
                }
            };
            let colour = map(&material.colour_map, Kind::Colour, "colour");
            let normal = map(&material.normal_map, Kind::Normal, "normal");
            materials.push((material, colour, normal));
        }
        let texels: Vec<Arc<Texels>> = shown.all.into_iter().map(Arc::new).collect();
        let laid = |(at, map): (usize, looks::TextureMap)| Map {
            texels: texels[at].clone(),
            set: map.set,
            picture_from_uv: map.picture_from_uv,
            wrap: map.wrap,
            nearest: map.nearest,
        };
        let materials: Vec<MaterialMaps> = materials
            .into_iter()
            .map(|(material, colour, normal)| MaterialMaps {
                colour: material.colour,
                colour_map: colour.map(laid),
                normal_map: normal.map(laid),
                normal_scale: material.normal_scale,
                cutoff: material.cutoff,
            })
            .collect();
        let more = remarks.len().saturating_sub(MOST_REMARKS);
        remarks.truncate(MOST_REMARKS);
        let file = files::shown(&self.file);
        let mut remarks: Vec<String> =
            remarks.into_iter().map(|remark| format!("{file}: {remark}")).collect();
        remarks.extend((more > 0).then(|| format!("{file}: {more} more maps are not shown")));
        FileLooks { materials: materials.into(), looks: self.looks, remarks, file: self.file }
    }
}

/// Pictures as they are decoded.
#[derive(Default)]
struct Shown {
    all: Vec<Texels>,
    numbers: BTreeMap<(usize, bool), Result<usize, String>>,
}

impl Shown {
    fn picture(&mut self, number: usize, picture: &Picture, kind: Kind) -> Result<usize, String> {
        let key = (number, kind == Kind::Normal);
        if let Some(known) = self.numbers.get(&key) {
            return known.clone();
        }
        let read = Texels::read(&picture.bytes, kind).map(|texels| {
            self.all.push(texels);
            self.all.len() - 1
        });
        while self.all.iter().map(Texels::count).sum::<u64>() > MOST_TEXELS {
            let Some(largest) = self.all.iter_mut().max_by_key(|texels| texels.count()) else {
                break;
            };
            largest.halve();
        }
        self.numbers.insert(key, read.clone());
        read
    }
}

/// The looks of a mesh file, ready to be drawn.
#[derive(Debug)]
pub(crate) struct FileLooks {
    file: PathBuf,
    looks: Looks,
    materials: Arc<[MaterialMaps]>,
    remarks: Vec<String>,
}

impl FileLooks {
    /// The head as a skin asks for, and what of it cannot be shown.
    pub(crate) fn head(&self, scalp: &Scalp, skin: Skin) -> (Solid, Vec<String>) {
        let tone = skin.tone();
        let mut remarks = self.remarks.clone();
        let wanted = match skin {
            Skin::Tone(_) => return (head_solid(scalp, tone), vec![]),
            Skin::Auto => self.materials.iter().any(|material| material.colour_map.is_some()),
            Skin::File => self.materials.iter().any(MaterialMaps::is_drawn),
        };
        let file = files::shown(&self.file);
        if !wanted {
            // Who did not ask for its colours is told only of those that it names.
            if skin == Skin::Auto && !self.looks.names_colours {
                remarks.clear();
            }
            if skin == Skin::File && remarks.is_empty() {
                remarks.push(format!(
                    "{file}: it brings no colours and no maps, so the head has a skin tone"
                ));
            }
            return (head_solid(scalp, tone), remarks);
        }
        let has_maps = |m: &MaterialMaps| m.colour_map.is_some() || m.normal_map.is_some();
        if scalp.uvs().is_none() && self.materials.iter().any(has_maps) {
            remarks.push(format!(
                "{file}: its mesh has no uvs to lay maps by, so the head has a skin tone"
            ));
            return (head_solid(scalp, tone), remarks);
        }
        match head_with_maps(scalp, tone, &self.looks, &self.materials) {
            Ok(head) => (head, remarks),
            Err(reason) => {
                remarks.push(format!("{file}: {reason}"));
                (head_solid(scalp, tone), remarks)
            }
        }
    }
}

/// When a file was changed last, and its size.
#[cfg(feature = "editor")]
type Stamp = Option<(std::time::SystemTime, u64)>;

/// Looks that were read already, for whoever draws the same heads again and again.
#[cfg(feature = "editor")]
#[derive(Default)]
pub(crate) struct Kept(Vec<(PathBuf, Stamp, Option<Arc<FileLooks>>)>);

#[cfg(feature = "editor")]
impl Kept {
    /// The looks of each file, and no others are kept.
    pub(crate) fn of(&mut self, files: &[Option<PathBuf>]) -> Vec<Option<Arc<FileLooks>>> {
        let mut kept = vec![];
        let found = files.iter().map(|file| {
            let file = file.as_ref()?;
            let about = std::fs::metadata(file).ok();
            let stamp = about.and_then(|about| Some((about.modified().ok()?, about.len())));
            let same = |(path, at, _): &&(PathBuf, Stamp, _)| path == file && *at == stamp;
            let known = self.0.iter().find(same).map(|(.., looks)| looks.clone());
            let looks = known
                .unwrap_or_else(|| HeadLooks::read(file).map(|named| Arc::new(named.decoded())));
            kept.push((file.clone(), stamp, looks.clone()));
            looks
        });
        let found = found.collect();
        self.0 = kept;
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "mtllib head.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
        usemtl skin\nf 1/1 2/2 3/3\nusemtl cloth\nf 3/3 1/1 2/2\n";
    /// A PNG of 2 x 2 pixels (128, 128, 255), and one of grey ones.
    const NORMALS: &[u8] = b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x02\x00\x00\x00\x02\x08\x02\x00\x00\
        \x00\xfd\xd4\x9a\x73\x00\x00\x00\x10\x49\x44\x41\x54\x78\x9c\x63\x68\x68\xf8\x0f\x44\x0c\x10\x0a\x00\x35\xf6\x07\
        \xfd\x49\x28\x43\xcc\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";
    const GREY: &[u8] = b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x02\x00\x00\x00\x02\x08\x02\x00\x00\
        \x00\xfd\xd4\x9a\x73\x00\x00\x00\x0e\x49\x44\x41\x54\x78\x9c\x63\x88\x02\x03\x06\x08\x05\x00\x1d\x96\x04\x39\xb2\
        \x96\xc2\x01\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

    /// What is read of a head with these files beside it, as materials with or without colour and normal map, and remarks
    /// without the folder's name.
    fn read(mtl: &str, files: &[(&str, &[u8])]) -> (Vec<(bool, bool)>, Vec<String>, usize) {
        static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let n = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("coif-looks-{}-{n}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let all = [("head.obj", HEAD.as_bytes()), ("head.mtl", mtl.as_bytes())];
        for (name, bytes) in all.iter().chain(files) {
            std::fs::write(folder.join(name), bytes).expect("a file");
        }
        let named = HeadLooks::read(&folder.join("head.obj")).expect("a mesh");
        let beside = named.beside.len();
        let looks = named.decoded();
        let _ = std::fs::remove_dir_all(&folder);
        let has = |m: &MaterialMaps| (m.colour_map.is_some(), m.normal_map.is_some());
        let start = format!("{}/head.obj: ", folder.display());
        let told = looks.remarks.iter().map(|r| r.strip_prefix(&start).unwrap_or(r).to_owned());
        (looks.materials.iter().map(has).collect(), told.collect(), beside)
    }

    #[test]
    fn maps_are_read_beside_the_mesh_and_a_bump_map_is_shown_where_it_holds_normals() {
        let mtl =
            "newmtl skin\nmap_Kd grey.png\nmap_Bump normals.png\nnewmtl cloth\nbump grey.png\n";
        let (maps, told, beside) = read(mtl, &[("grey.png", GREY), ("normals.png", NORMALS)]);
        assert_eq!(maps, [(true, true), (false, false)]);
        let heights = "material \"cloth\": its normal map grey.png is not shown: it holds heights, and only maps of normals are shown";
        assert_eq!(told, [heights]);
        assert_eq!(beside, 3, "the materials and two pictures are read, each once");
    }

    #[test]
    fn bad_pictures_are_remarks_with_material_picture_and_remedy() {
        for (bytes, says) in [
            (&b"GIF89a"[..], "give a PNG or JPEG file"),
            (&GREY[..50], "save it anew as PNG or JPEG"),
            (b"\xff\xd8\xff\xe0\x00\x10JFIF\0", "save it anew as PNG or JPEG"),
            (b"", "give a PNG or JPEG file"),
        ] {
            let (maps, told, _) = read("newmtl skin\nmap_Kd a.png\n", &[("a.png", bytes)]);
            assert_eq!(maps, [(false, false); 2]);
            let begins = "material \"skin\": its colour map a.png is not shown: ";
            assert!(told.len() == 1 && told[0].starts_with(begins), "{told:?}");
            assert!(told[0].ends_with(says) && told[0].lines().count() == 1, "{told:?}");
        }
    }
}
