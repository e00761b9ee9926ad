//! The one way to what partings made of a scalp: told by place, or all of it, and noted either way.
//!
//! Guarantees: a handle that notes ([`Sections::noting`]) gives nothing that comes of partings without a note of it, for no other
//! module sees the data: by place it goes through [`Sections::seen`], and all else through [`Sections::all`]. What is not noted is the
//! head's own, or told by every footprint (`widest_half`).

use super::{NONE, Names, Parting, Section};
use crate::data::chart::ChartProjection;
use crate::data::cut::Cut;
use crate::data::lines::{Lines, LinesView};
use crate::data::mesh_cut::MeshCut;
use crate::data::read_set::{Digests, Footprint, Reads};
use crate::data::scalp::Scalp;
use crate::maths::hash::Key;
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// The sections of one scalp, as whoever holds them sees them: a piece of work that runs by place sees its own, which note what it
/// asks. Cheap to clone.
#[derive(Clone)]
pub struct Sections {
    cuts: Arc<Cuts>,
    reads: Option<Arc<Reads>>,
}

struct Cuts {
    spread: ChartProjection,
    /// Distance of the skin from the centre in each cell, cm.
    out: Vec<f32>,
    is_of_a_mesh: bool,
    /// Half the width of the widest parting, cm.
    widest: f32,
    lines: Lines,
    all: All,
    digests: OnceLock<Digests>,
}

/// What is no one place's.
pub(super) struct All {
    pub(super) key: Key,
    pub(super) list: Vec<Section>,
    pub(super) partings: Vec<Parting>,
    pub(super) names: Names,
    /// Index of each cell's section, or [`NONE`].
    pub(super) labels: Vec<u32>,
    /// Sections cut along the mesh, if the map does not show the region.
    pub(super) mesh: Option<MeshCut>,
}

impl Sections {
    /// What was cut, without names, and without the list where the map was cut.
    pub(super) fn cut(
        scalp: &Scalp,
        key: Key,
        cut: Cut,
        mesh: Option<(MeshCut, Vec<Section>)>,
    ) -> Self {
        let spread = scalp.chart().spread();
        let Cut { partings, lines, labels, .. } = cut;
        let (mesh, list) = mesh.unzip();
        let cuts = Cuts {
            spread,
            out: scalp.chart().spots().iter().map(|spot| spread.out(spot.point)).collect(),
            is_of_a_mesh: mesh.is_some(),
            widest: partings.iter().fold(0.0, |widest, line| line.half_width.max(widest)),
            lines,
            all: All {
                key,
                list: list.unwrap_or_default(),
                partings,
                names: Names::default(),
                labels,
                mesh,
            },
            digests: OnceLock::new(),
        };
        Self { cuts: cuts.into(), reads: None }
    }

    /// The same, listed and named.
    ///
    /// # Panics
    /// If they are already shared.
    pub(super) fn called(mut self, list: Vec<Section>, names: Names) -> Self {
        let all = &mut Arc::get_mut(&mut self.cuts).expect("fresh sections").all;
        (all.list, all.names) = (list, names);
        self
    }

    /// The same for one piece of work: what is asked of these is noted.
    pub(crate) fn noting(&self) -> Self {
        Self { cuts: self.cuts.clone(), reads: Some(Reads::new().into()) }
    }

    /// What was asked of these so far; of such as note nothing, nothing.
    pub(crate) fn footprint(&self) -> Footprint {
        let plain = Self { cuts: self.cuts.clone(), reads: None };
        match &self.reads {
            Some(reads) => reads.footprint(&plain),
            None => Reads::new().footprint(&plain),
        }
    }

    /// What is told by place.
    #[inline]
    pub(super) fn seen(&self) -> LinesView<'_> {
        self.cuts.lines.seen(&self.cuts.all.labels, self.reads.as_deref())
    }

    /// All else.
    pub(super) fn all(&self) -> &All {
        if let Some(reads) = &self.reads {
            reads.all();
        }
        &self.cuts.all
    }

    /// The cut along the mesh, if the map does not show the region; it is no one place's.
    #[inline]
    pub(super) fn mesh(&self) -> Option<&MeshCut> {
        if self.cuts.is_of_a_mesh { self.all().mesh.as_ref() } else { None }
    }

    /// Id of a section whose number was told by place: digests of places hold ids.
    pub(super) fn id(&self, section: u32) -> u64 {
        self.cuts.id(section)
    }

    /// The map's projection.
    #[inline]
    pub(super) fn spread(&self) -> &ChartProjection {
        &self.cuts.spread
    }

    /// Distance of the skin from the centre in a cell, cm.
    #[inline]
    pub(super) fn out(&self, cell: usize) -> f32 {
        self.cuts.out[cell]
    }

    /// Whether the sections were cut along a mesh that the map does not show: hair is not led within them.
    pub fn are_of_a_mesh(&self) -> bool {
        self.cuts.is_of_a_mesh
    }

    /// Half the width of the widest parting, cm.
    pub fn widest_half(&self) -> f32 {
        self.cuts.widest
    }

    /// Digests by place, computed on first use.
    pub(in crate::data) fn digests(&self) -> &Digests {
        let cuts = &*self.cuts;
        let id = |label| if label == NONE { 0 } else { cuts.id(label) };
        cuts.digests.get_or_init(|| cuts.lines.digests(&cuts.all.labels, id, cuts.widest))
    }

    /// Where they are held, and bytes held.
    pub(in crate::data) fn buffer(&self) -> (usize, usize) {
        let Cuts { out, lines, all, .. } = &*self.cuts;
        let bytes = lines.bytes()
            + all.mesh.as_ref().map_or(0, MeshCut::bytes)
            + all.partings.iter().map(|p| size_of::<Vec3>() * p.points.len() + 64).sum::<usize>()
            + 4 * (all.labels.len() + out.len())
            + all.list.len() * 128;
        (Arc::as_ptr(&self.cuts) as usize, bytes)
    }
}

impl Cuts {
    fn id(&self, section: u32) -> u64 {
        self.all.list.get(section as usize).map_or(0, |section| section.id)
    }
}

impl std::fmt::Debug for Sections {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let All { list, partings, .. } = &self.cuts.all;
        write!(f, "Sections({} by {} partings)", list.len(), partings.len())
    }
}
