//! What the drawing thread does with a scene: sends what changed to the renderer and draws, a rough picture first.
//!
//! Guaranteed: what did not change is not sent again; a picture at rest is the one that `coif render` makes of the same hair
//! with the same settings, to within one step of 255. Rough pictures have fewer pixels, lighter light and, on software
//! adapters, a share of very much hair.

use super::drawing::{DrawRequest, Drawn, Ends, HairHit, PickQuery, PickResult};
use super::select::visible;
use crate::scene::looks::Kept;
use crate::scene::{Dressed, Show, Skin, heads};
use coif_nodes::data::curves::Curves;
use coif_shaders::surface::{RootGrid, Solid};
use coif_shaders::view::{Legend, Paint};
use coif_shaders::{Effort, Gpu, Look, RenderError, Renderer};
use egui::{Color32, ColorImage};
use glam::Vec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A first picture that takes longer is made with fewer pixels while something moves, milliseconds.
const SLOW_MS: f64 = 160.0;
/// One that takes less may have more of them.
const QUICK_MS: f64 = 50.0;
/// The widest pixel of a rough picture, in pixels of the screen.
const WIDEST: u32 = 4;
/// A first whole picture that is expected to take longer is led by a rough one, milliseconds.
const PATIENCE_MS: f64 = 120.0;
/// Points of hair that a rough picture has at most on a software adapter.
const ROUGH_POINTS: f32 = 400_000.0;
/// Samples of a rough picture while a hand holds still, and how long it must have done so: until then the processor is left
/// to whatever makes the next scene.
const ROUGH_SAMPLES: u32 = 4;
const HELD: Duration = Duration::from_millis(200);
/// How far from the pointer hair is found, pixels of the screen.
const REACH: u32 = 4;

/// A picture in the making.
pub(super) struct Painter {
    renderer: Renderer,
    /// What the renderer was last given; nothing at first.
    given: Option<DrawRequest>,
    look: Option<Look>,
    /// The lights' own exposure, stops.
    exposure: f32,
    heads: Vec<Solid>,
    ground: Option<Solid>,
    /// The looks that heads bring along.
    looks: Kept,
    /// What of them cannot be shown.
    remarks: Vec<String>,
    roots: Option<RootGrid>,
    /// How many strands of the final hair each that is drawn stands for.
    stands_for: f32,
    legend: Option<Legend>,
    notice: Option<String>,
    /// Curves and points that are drawn at most.
    drawn: (usize, usize),
    /// Whether the picture being made is a rough one.
    rough: bool,
    /// Screen pixels across one of a rough picture.
    wide: u32,
    /// When this scene was begun, and when its first sample was.
    began: Instant,
    first_began: Instant,
    /// Milliseconds that the last first sample of a picture at rest took.
    first_at_rest: Option<f64>,
    uploaded: Instant,
    /// Samples of the last picture handed over, and when that was.
    shown: u32,
    handed_over: Instant,
}

impl Painter {
    pub(super) fn new(gpu: Arc<Gpu>, wanted: &DrawRequest) -> Result<Self, RenderError> {
        let software = gpu.is_software();
        let mut renderer = Renderer::new(gpu, wanted.size[0].max(1), wanted.size[1].max(1))?;
        renderer.warm_up(&wanted.look, wanted.shading());
        let now = Instant::now();
        Ok(Self {
            renderer,
            given: None,
            look: None,
            exposure: 0.0,
            heads: vec![],
            ground: None,
            looks: Kept::default(),
            remarks: vec![],
            roots: None,
            stands_for: 1.0,
            legend: None,
            notice: None,
            drawn: (0, 0),
            rough: true,
            wide: if software { 2 } else { 1 },
            began: now,
            first_began: now,
            first_at_rest: software.then_some(f64::INFINITY),
            uploaded: now,
            shown: 0,
            handed_over: now,
        })
    }

    /// Takes a scene instead of the one before.
    ///
    /// # Errors
    /// When the adapter has no room for such a picture.
    pub(super) fn begin(&mut self, wanted: &DrawRequest) -> Result<(), RenderError> {
        self.began = Instant::now();
        let old = self.given.take();
        let changed = |differs: fn(&DrawRequest, &DrawRequest) -> bool| {
            old.as_ref().is_none_or(|old| differs(old, wanted))
        };
        if changed(|a, b| a.lights != b.lights) {
            let rig = wanted.lights.rig();
            self.exposure = rig.exposure;
            self.renderer.set_rig(&rig);
        }
        let new_heads = changed(|a, b| !a.same_heads(b));
        if new_heads {
            let looks = match wanted.skin {
                Skin::Tone(_) => vec![],
                Skin::Auto | Skin::File => self.looks.of(&wanted.files),
            };
            (self.heads, self.remarks) = match wanted.head {
                true => heads(&wanted.scalps, wanted.skin, &looks),
                false => (vec![], vec![]),
            };
        }
        let new_hair = changed(|a, b| !a.same_hair(b) || !a.same_scalps(b));
        if new_hair || new_heads {
            self.dress(wanted, new_heads, changed(|a, b| a.show != b.show));
        }
        self.uploaded = Instant::now();
        self.renderer.set_camera(&wanted.camera);
        // A change that leaves all as it is but the number of samples goes on with what is there.
        let same_picture = old.as_ref().is_some_and(|old| old.same_picture(wanted));
        let rough = match same_picture {
            true => self.rough && (wanted.moving || self.renderer.progress().samples == 0),
            false => wanted.moving || self.first_at_rest.is_some_and(|ms| ms > PATIENCE_MS),
        };
        self.given = Some(wanted.clone());
        self.prepare(rough)
    }

    /// Gives the renderer hair, and solids where they changed.
    fn dress(&mut self, wanted: &DrawRequest, new_heads: bool, new_show: bool) {
        let hair = visible(&wanted.hair, &wanted.visibility);
        let scalp = wanted.scalps.first().map(|s| &**s);
        let follows = !matches!(wanted.show, Show::Hair(_));
        let dressed = match follows && wanted.followed.curve_count() == 0 {
            true => Err("no curves that this hair follows are known".to_owned()),
            false => Dressed::of(&wanted.show, (&hair, wanted.stands_for), &wanted.followed, scalp),
        };
        self.notice = dressed.as_ref().err().or(self.remarks.first()).cloned();
        let dressed = dressed.unwrap_or_else(|_| Dressed {
            drawn: hair.clone(),
            paint: Paint::plain(Vec3::splat(0.25)),
            tubes: None,
            roots: None,
            stands_for: wanted.stands_for,
        });
        let ground = dressed.ground(&self.heads);
        if new_heads || new_show || dressed.tubes.is_some() || self.ground != ground {
            let solids = self.heads.iter().chain(&ground).chain(&dressed.tubes);
            self.renderer.set_solids(solids.cloned().collect());
            self.ground = ground;
        }
        // Most changes leave hair where it grows.
        if self.roots != dressed.roots {
            self.roots.clone_from(&dressed.roots);
            self.renderer.set_roots(dressed.roots);
        }
        self.renderer.set_hair(&dressed.drawn, &dressed.paint);
        self.stands_for = dressed.stands_for;
        self.legend = dressed.paint.legend;
        self.drawn = (dressed.drawn.curve_count(), dressed.drawn.point_count());
    }

    /// Sets the renderer to rough pictures or whole ones.
    fn prepare(&mut self, rough: bool) -> Result<(), RenderError> {
        let Some(wanted) = &self.given else { return Ok(()) };
        self.rough = rough;
        let wide = if rough { self.wide } else { 1 };
        let [width, height] = wanted.size.map(|n| n.div_ceil(wide).max(1));
        let share = wanted.look.share * self.rough_share(rough);
        let look = Look { share, stands_for: self.stands_for, ..wanted.look };
        let effort = if rough { Effort::Moving } else { Effort::Still };
        self.renderer.set_effort(effort);
        if self.look != Some(look) {
            self.look = Some(look);
            self.renderer.set_look(&look);
        }
        self.renderer.resize(width, height)?;
        if self.renderer.progress().samples == 0 {
            self.shown = 0;
            self.first_began = Instant::now();
        }
        Ok(())
    }

    /// Share of the hair that is enough.
    fn rough_share(&self, rough: bool) -> f32 {
        match rough && self.renderer.gpu().is_software() {
            true => (ROUGH_POINTS / self.drawn.1.max(1) as f32).clamp(0.05, 1.0),
            false => 1.0,
        }
    }

    /// Samples that the present picture is to have.
    fn samples(&self) -> u32 {
        match &self.given {
            Some(wanted) if !self.rough => wanted.samples.max(1),
            Some(wanted) if wanted.moving => ROUGH_SAMPLES.min(wanted.samples.max(1)),
            Some(_) => 1,
            None => 0,
        }
    }

    /// How long to wait for a newer scene before this one is refined.
    pub(super) fn pause(&self) -> Option<Duration> {
        let held = self.rough && self.shown > 0 && !self.goes_on();
        let since = self.handed_over.elapsed();
        (held && since < HELD).then(|| HELD - since)
    }

    /// Whether the first rough picture of this scene is being made, after which a newer scene may come.
    pub(super) fn is_first(&self) -> bool {
        self.rough && self.given.is_some() && self.renderer.progress().samples == 0
    }

    /// Whether there is nothing to do.
    pub(super) fn is_done(&self) -> bool {
        self.given.is_none()
            || (self.renderer.progress().samples >= self.samples() && !self.goes_on())
    }

    /// Whether a whole picture follows the rough one.
    fn goes_on(&self) -> bool {
        self.rough && self.given.as_ref().is_some_and(|wanted| !wanted.moving)
    }

    /// Draws for a slice of time. Gives a picture when one is due: after 1, 2, 4, 8 and so on samples, and the last.
    ///
    /// # Errors
    /// When the device is gone or has no room.
    pub(super) fn advance(&mut self) -> Result<Option<Drawn>, RenderError> {
        if self.renderer.progress().samples >= self.samples() && self.goes_on() {
            self.prepare(false)?;
        }
        let of = self.samples();
        let before = self.renderer.progress().samples;
        let now = self.renderer.advance(of, Duration::ZERO).samples;
        if let Some(lost) = self.renderer.lost() {
            return Err(lost);
        }
        if now > before && before == 0 {
            self.learn(self.first_began.elapsed().as_secs_f64() * 1e3);
        }
        let due = now > before && (now.is_power_of_two() || now == of) && now > self.shown;
        Ok(due.then(|| self.hand_over()).flatten())
    }

    /// Learns how many pixels a rough picture may have, or how long a whole one takes.
    fn learn(&mut self, ms: f64) {
        if !self.rough {
            self.first_at_rest = Some(ms);
        } else if ms > SLOW_MS {
            self.wide = (self.wide + 1).min(WIDEST);
        } else if ms < QUICK_MS {
            self.wide = (self.wide - 1).max(1);
        }
    }

    /// The picture so far.
    fn hand_over(&mut self) -> Option<Drawn> {
        let wanted = self.given.clone()?;
        let exposure = self.exposure + wanted.exposure;
        let rgba = self.renderer.shown(wanted.transform, exposure);
        let (width, height) = self.renderer.size();
        self.shown = self.renderer.progress().samples;
        self.handed_over = Instant::now();
        let pixels = rgba.chunks_exact(4).map(|c| Color32::from_rgb(c[0], c[1], c[2])).collect();
        let image = ColorImage::new([width as usize, height as usize], pixels);
        let share = wanted.look.share * self.rough_share(self.rough);
        Some(Drawn {
            image: Arc::new(image),
            samples: self.shown,
            of: wanted.samples.max(1),
            wide: if self.rough { self.wide } else { 1 },
            rough: self.rough,
            strands: self.drawn.0,
            points: self.drawn.1,
            share,
            legend: self.legend.clone(),
            notice: self.notice.clone(),
            ends: Ends { began: self.began, uploaded: self.uploaded, drawn: Instant::now() },
            wanted,
        })
    }

    /// What lies under a place of the picture, once there is one.
    pub(super) fn pick(&mut self, pick: &PickQuery) -> PickResult {
        let mut picked = PickResult { number: pick.number, hair: None, skin: None };
        let Some(wanted) = &self.given else { return picked };
        let skin = wanted
            .scalps
            .iter()
            .filter_map(|scalp| scalp.surface().ray(pick.ray.origin, pick.ray.direction, 1e5));
        picked.skin = skin.min_by(|a, b| a.distance.total_cmp(&b.distance)).filter(|_| wanted.head);
        if wanted.camera != pick.camera {
            return picked;
        }
        let (width, height) = self.renderer.size();
        let pixel = |at: f32, n: u32| (at.clamp(0.0, 1.0) * n as f32).min(n as f32 - 1.0) as u32;
        let reach = REACH.div_ceil(if self.rough { self.wide } else { 1 });
        let at = (pixel(pick.at[0], width), pixel(pick.at[1], height));
        if let Some((tuft, curve, point)) = self.renderer.pick(at.0, at.1, reach) {
            let points = tuft.curve(curve);
            let point = point.saturating_sub(tuft.range(curve).start);
            // The segment begins at this point; its nearest end to the ray is what was seen.
            let a = points.get(point).copied().unwrap_or_default();
            let b = points.get(point + 1).copied().unwrap_or(a);
            let off = |p: Vec3| (p - pick.ray.origin).cross(pick.ray.direction).length();
            let place = if off(a) <= off(b) { a } else { b };
            picked.hair = Some(HairHit { tuft, curve, point, place });
        }
        picked
    }

    /// Bytes that it takes on the device.
    pub(super) fn bytes(&self) -> usize {
        self.renderer.gpu().bytes()
    }

    /// Name and driver of what draws.
    pub(super) fn adapter(&self) -> String {
        let info = &self.renderer.gpu().info;
        match info.driver_info.is_empty() {
            true => info.name.clone(),
            false => format!("{}, {}", info.name, info.driver_info),
        }
    }
}

/// Curves together.
pub(super) fn together(all: impl IntoIterator<Item = Curves>) -> Curves {
    Curves::new(all.into_iter().flat_map(|curves| curves.tufts().to_vec()).collect())
}
