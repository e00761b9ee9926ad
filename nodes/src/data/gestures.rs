//! Pen gestures as a document stores them: the pen's samples, the view they were drawn in, and their result.
//!
//! A gesture is drawn on a picture. It stores the pen's samples in pixels and the view in the head frame, so that it
//! means the same on another head; the ids of the curves it acts on; and, if it made a new curve, that curve in the
//! frame of its root.
//!
//! Guarantees: unusable gestures are found before anything runs ([`Gestures::fault`]). Not known here: what a gesture
//! does (`sketch/`), and how files store it.

use super::scalp::{HEAD_RADIUS, Root};
use crate::maths::frame::{across, any_normal};
use crate::maths::hash::{Key, KeyBuilder};
use glam::{Vec2, Vec3};

/// One sample of the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub struct PenSample {
    /// Pixels from the centre of the picture, to the right and down.
    pub at: Vec2,
    /// 0 to 1.
    pub pressure: f32,
    /// Seconds since the gesture began.
    pub time: f32,
    /// Tilt of the pen to the right and toward the user, as a fraction of 90 degrees, each -1 to 1.
    pub tilt: Vec2,
}

/// View in which a gesture was drawn, in the head frame and head units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GestureView {
    /// Position of the eye.
    pub eye: Vec3,
    /// Point the eye looks at; not the eye itself.
    pub target: Vec3,
    /// Up direction of the picture; not parallel to the view.
    pub up: Vec3,
    /// Half the height of the picture at one head unit from the eye; for a parallel projection, in head units.
    pub half_height: f32,
    /// Whether the projection is parallel.
    pub parallel: bool,
    /// Height of the picture in pixels.
    pub pixels: f32,
}

/// Effect of a gesture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tool {
    /// A new cluster from a point of the scalp.
    Implant,
    /// Continues a cluster from its tip.
    Lengthen,
    /// Cuts curves at the stroke; on the scalp, removes them whole.
    Cut,
    /// Each full circle makes clusters a little denser (clockwise) or thinner.
    Density,
    /// Each loop twists a cluster from there on.
    Twist,
    /// The width of a scribble sets how much strands wander.
    Frizz,
    /// Pushes curves along the stroke.
    Comb,
    /// Fixes the nearest CV in place, or all under its brush, or frees them.
    Pin,
    /// Smooths what the brush passes.
    Smooth,
    /// Lifts curves off the skin.
    Puff,
    /// Drags curves along.
    Grab,
    /// Straightens curves between root and tip.
    Straighten,
    /// Moves one CV, and with a size those around it.
    Point,
    /// Redraws a curve from a point on it to its tip.
    Redraw,
    /// Copies of a cluster along the stroke.
    Scatter,
    /// A new cluster as wide as its drawn outline.
    Silhouette,
}

impl Tool {
    /// Every tool and its word in documents, in the order of the toolbar.
    pub const ALL: &[(Tool, &str)] = &[
        (Tool::Implant, "implant"),
        (Tool::Lengthen, "lengthen"),
        (Tool::Cut, "cut"),
        (Tool::Density, "density"),
        (Tool::Twist, "twist"),
        (Tool::Frizz, "frizz"),
        (Tool::Comb, "comb"),
        (Tool::Pin, "pin"),
        (Tool::Smooth, "smooth"),
        (Tool::Puff, "puff"),
        (Tool::Grab, "grab"),
        (Tool::Straighten, "straighten"),
        (Tool::Point, "point"),
        (Tool::Redraw, "redraw"),
        (Tool::Scatter, "scatter"),
        (Tool::Silhouette, "silhouette"),
    ];
    /// Its word in documents and messages.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(tool, _)| *tool == self).map_or("", |(_, word)| word)
    }
    /// The tool with this word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, own)| *own == word).map(|(tool, _)| *tool)
    }
    /// Whether its size, if it has one, is how far around what it acts on curves follow, the less the farther they are.
    pub fn is_soft(self) -> bool {
        use Tool::{Cut, Density, Frizz, Lengthen, Point, Redraw, Twist};
        matches!(self, Point | Lengthen | Redraw | Cut | Twist | Frizz | Density)
    }
}

/// How deep a gesture reaches: the paper's three levels of pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// The curve nearest to the eye.
    Nearest,
    /// All curves down to the head.
    Through,
    /// The head itself, and what is rooted there.
    Scalp,
}

impl Layer {
    /// Every layer and its word in documents, from light to heavy pressure.
    pub const ALL: &[(Layer, &str)] =
        &[(Layer::Nearest, "nearest"), (Layer::Through, "through"), (Layer::Scalp, "scalp")];
    /// Its word in documents and messages.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(layer, _)| *layer == self).map_or("", |(_, word)| word)
    }
    /// The layer with this word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, own)| *own == word).map(|(layer, _)| *layer)
    }
    /// The layer of a pressure from 0 to 1: three equal levels.
    pub fn of_pressure(pressure: f32) -> Self {
        match pressure {
            p if p < 1.0 / 3.0 => Layer::Nearest,
            p if p < 2.0 / 3.0 => Layer::Through,
            _ => Layer::Scalp,
        }
    }
}

/// A gesture.
#[derive(Clone, Debug, PartialEq)]
pub struct Gesture {
    /// Stored with the gesture, unique within its list, never 0. The id of an implanted curve derives from it.
    pub id: u64,
    /// Its effect.
    pub tool: Tool,
    /// How deep it reaches.
    pub layer: Layer,
    /// The view it was drawn in.
    pub view: GestureView,
    /// At least one.
    pub samples: Vec<PenSample>,
    /// Ids of the curves it acts on; for a scatter, the curve it copies. Empty: whatever lies under the pen at each
    /// replay.
    pub curves: Vec<u64>,
    /// Root of an implant or silhouette, in the head frame and head units. `None`: where the ray through the first
    /// sample, or between the ends of an outline, hits the head.
    pub root: Option<Vec3>,
    /// The drawn curve of an implant, silhouette, lengthening or redrawing, without its first point, in the frame of
    /// its root or of the point where it continues, in head units ([`RootFrame`]). For a scatter, the roots of its
    /// copies, in the head frame and head units. Empty: made from the samples at each replay.
    pub path: Vec<Vec3>,
    /// Colour of an implant, linear Rec.709. `None`: the default colour.
    pub colour: Option<Vec3>,
    /// Radius of a brush or comb, pixels; 0: the node's own, for a scatter, the stroke only. For a tool that
    /// [is soft](Tool::is_soft), how far around what it acts on others follow; 0: none do.
    pub size: f32,
    /// Strength of a brush, relative to its default; of a comb, how far hair goes along with the pen: 1 all the way.
    pub strength: f32,
}

/// Result of one replayed gesture, for reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replayed {
    /// The gesture's id.
    pub id: u64,
    /// Its tool's word.
    pub tool: &'static str,
    /// Distance of an implant's root from where the head frame puts it, cm; `None` if the original position is unknown.
    pub drift: Option<f32>,
    /// Mean angle over its length between the result and the stored path, in the frame of its root or old tip, degrees;
    /// `None` without a stored path.
    pub turned: Option<f32>,
    /// How many curves it names for its tool to act on.
    pub named: usize,
    /// How many curves it took: of the named ones those that exist, or else those under the pen.
    pub picked: usize,
    /// How many curves it made, changed or removed.
    pub changed: usize,
    /// Ids of named curves that no longer exist.
    pub orphaned: Vec<u64>,
    /// What it could not do.
    pub said: Vec<String>,
}

impl Replayed {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let said: usize = self.said.iter().map(|text| text.len() + size_of::<String>()).sum();
        size_of::<Self>() + size_of_val(&self.orphaned[..]) + said
    }
}

/// The gestures of one node, in drawing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gestures(pub Vec<Gesture>);

/// Largest distance from the head's centre (head units), and largest picture size in pixels.
const FARTHEST: f32 = 1e5;
/// The most curves that one gesture may name.
const MOST_CURVES: usize = 100_000;

impl GestureView {
    /// Why the view is unusable; `None` if it is usable.
    pub fn fault(&self) -> Option<&'static str> {
        let near = |v: Vec3| v.is_finite() && v.abs().max_element() <= FARTHEST;
        let ahead = (self.target - self.eye).try_normalize();
        let turned = ahead.is_none_or(|ahead| ahead.cross(self.up).length() < 1e-4);
        let sized = |x: f32| x.is_finite() && x > 0.0 && x <= FARTHEST;
        match () {
            () if !near(self.eye) || !near(self.target) || !near(self.up) => {
                Some("its view is not on earth")
            }
            () if ahead.is_none() => Some("its view looks at its own eye"),
            () if turned => Some("the up of its view lies along the view"),
            () if !sized(self.half_height) || !sized(self.pixels) => Some("its view has no height"),
            () => None,
        }
    }
}

impl Gesture {
    /// Hash of the content.
    pub fn key(&self) -> Key {
        let view = &self.view;
        KeyBuilder::new("gesture")
            .int(self.id)
            .text(self.tool.word())
            .text(self.layer.word())
            .vec3(view.eye)
            .vec3(view.target)
            .vec3(view.up)
            .float(view.half_height)
            .int(u64::from(view.parallel))
            .float(view.pixels)
            .column(&self.samples)
            .column(&self.curves)
            .column(bytemuck::cast_slice::<_, f32>(&self.path))
            .float(self.size)
            .float(self.strength)
            .int(u64::from(self.root.is_some()))
            .vec3(self.root.unwrap_or_default())
            .int(u64::from(self.colour.is_some()))
            .vec3(self.colour.unwrap_or_default())
            .finish()
    }

    /// The same gesture on the other side of the head, without named curves there. Circles keep their direction, since
    /// it means denser or thinner; loops reverse, as hair does in a mirror.
    pub fn mirrored(&self) -> Self {
        let flip = |v: Vec3| v * Vec3::new(-1.0, 1.0, 1.0);
        let other = |s: &PenSample| PenSample {
            at: s.at * Vec2::new(-1.0, 1.0),
            tilt: s.tilt * Vec2::new(-1.0, 1.0),
            ..*s
        };
        let mut samples: Vec<PenSample> = self.samples.iter().map(other).collect();
        if self.tool == Tool::Density {
            let end = samples.last().map_or(0.0, |s| s.time);
            samples.reverse();
            samples.iter_mut().for_each(|s| s.time = end - s.time);
        }
        let view = &self.view;
        let view = GestureView {
            eye: flip(view.eye),
            target: flip(view.target),
            up: flip(view.up),
            ..*view
        };
        Self { view, samples, curves: vec![], root: None, path: vec![], ..self.clone() }
    }

    /// Why it cannot be used; `None` if it can.
    pub fn fault(&self) -> Option<String> {
        let finite = |s: &PenSample| {
            s.at.is_finite() && s.pressure.is_finite() && s.time.is_finite() && s.tilt.is_finite()
        };
        if let Some(fault) = self.view.fault() {
            return Some(fault.to_owned());
        }
        if self.samples.is_empty() {
            return Some("it has no samples".to_owned());
        }
        if let Some(i) = self.samples.iter().position(|s| !finite(s)) {
            return Some(format!("sample {i} is not a finite number"));
        }
        if let Some(i) = self.samples.iter().position(|s| s.at.abs().max_element() > FARTHEST) {
            return Some(format!("sample {i} is {FARTHEST} pixels and more off"));
        }
        let near = |v: &Vec3| v.is_finite() && v.abs().max_element() <= FARTHEST;
        if let Some(i) = self.path.iter().position(|p| !near(p)) {
            return Some(format!("point {i} of its path is not on earth"));
        }
        if self.root.is_some_and(|root| !near(&root)) {
            return Some("its root is not on earth".to_owned());
        }
        if self.curves.len() > MOST_CURVES {
            return Some(format!("it names {} curves, {MOST_CURVES} at most", self.curves.len()));
        }
        let sized = |x: f32, most: f32| x.is_finite() && (0.0..=most).contains(&x);
        if !sized(self.size, 1e4) || !sized(self.strength, 100.0) {
            return Some(format!(
                "its size is {} (0 to 10000 pixels), its strength {} (0 to 100)",
                self.size, self.strength
            ));
        }
        let shade = |c: Vec3| c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 100.0;
        self.colour.is_some_and(|c| !shade(c)).then(|| "its colour is none".to_owned())
    }
}

impl Gestures {
    /// Hash of the content.
    pub fn key(&self) -> Key {
        self.0.iter().fold(KeyBuilder::new("gestures"), |key, one| key.key(one.key())).finish()
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let each = |one: &Gesture| {
            size_of_val(&one.samples[..])
                + size_of_val(&one.curves[..])
                + size_of_val(&one.path[..])
        };
        self.0.iter().map(each).sum::<usize>() + self.0.len() * size_of::<Gesture>()
    }
    /// Why the list cannot be used; `None` if it can.
    pub fn fault(&self) -> Option<String> {
        let mut seen = std::collections::BTreeSet::new();
        for (i, one) in self.0.iter().enumerate() {
            if one.id == 0 || !seen.insert(one.id) {
                return Some(format!("gesture {i}: its id {} is 0 or used before", one.id));
            }
            if let Some(fault) = one.fault() {
                return Some(format!("gesture {i} ({}): {fault}", one.tool.word()));
            }
        }
        None
    }
}

/// Radius around a root within which normals are averaged, head units: larger than the whorls of an ear and the folds
/// of a scan.
const ABOUT: f32 = 2.0;

/// The frame in which a curve that grows from a point of the head is stored: out of the skin, down along it, and
/// across. Where the skin faces straight up or down, forward replaces down.
#[derive(Clone, Copy, Debug)]
pub struct RootFrame {
    origin: Vec3,
    /// Orthonormal: out, down along the skin, and across.
    axes: [Vec3; 3],
    unit: f32,
}

impl RootFrame {
    /// The frame at a root of a head. Out is the mean of the normals around the root, so that folds, ears and scan
    /// noise do not turn it.
    pub fn at(scalp: &super::scalp::Scalp, root: &Root) -> Self {
        let (frame, skin) = (scalp.frame(), scalp.skin());
        let aside = any_normal(root.normal);
        let reach = ABOUT * frame.unit();
        let (a, b) = (aside * reach, root.normal.cross(aside) * reach);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let round = [a, b, (a + b) * half, (a - b) * half].into_iter().flat_map(|v| [v, -v]);
        let normal = |off: Vec3| {
            let hit = skin.closest(root.point + off)?;
            Some(scalp.surface().smooth_normal(hit.triangle, hit.bary))
        };
        let out = round.filter_map(normal).fold(root.normal, |sum, normal| sum + normal);
        Self::of(frame, root.point, out)
    }
    /// The frame at any point, for an outward direction.
    pub fn of(frame: &super::scalp::HeadFrame, origin: Vec3, out: Vec3) -> Self {
        let out = out.normalize_or(frame.up);
        // Forward counts slightly, so that near the crown down turns to it without a jump.
        let down = across(frame.forward * 0.25 - frame.up, out).unwrap_or_else(|| any_normal(out));
        Self { origin, axes: [out, down, out.cross(down)], unit: frame.radius / HEAD_RADIUS }
    }
    /// A point in this frame, head units.
    pub fn local(&self, p: Vec3) -> Vec3 {
        let off = (p - self.origin) / self.unit;
        Vec3::from(self.axes.map(|axis| off.dot(axis)))
    }
    /// A point of this frame in the head's space, cm.
    pub fn world(&self, p: Vec3) -> Vec3 {
        let [out, down, aside] = self.axes;
        self.origin + (out * p.x + down * p.y + aside * p.z) * self.unit
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::data::scalp::HeadFrame;

    /// A gesture of two samples, seen from the front.
    pub(crate) fn gesture(id: u64, tool: Tool) -> Gesture {
        let sample =
            |x: f32| PenSample { at: Vec2::new(x, 0.0), pressure: 0.5, ..Default::default() };
        Gesture {
            id,
            tool,
            layer: Layer::Through,
            view: GestureView {
                eye: Vec3::Z * 60.0,
                target: Vec3::ZERO,
                up: Vec3::Y,
                half_height: 0.25,
                parallel: false,
                pixels: 1000.0,
            },
            samples: vec![sample(0.0), sample(100.0)],
            curves: vec![],
            root: None,
            path: vec![],
            colour: None,
            size: 0.0,
            strength: 1.0,
        }
    }

    #[test]
    fn each_word_leads_to_its_tool_and_layer_and_three_levels_are_equal() {
        for (tool, word) in Tool::ALL {
            assert_eq!((Tool::named(word), tool.word()), (Some(*tool), *word));
        }
        for (layer, word) in Layer::ALL {
            assert_eq!((Layer::named(word), layer.word()), (Some(*layer), *word));
        }
        let levels = [0.0, 0.33, 0.34, 0.66, 0.67, 1.0].map(Layer::of_pressure);
        use Layer::{Nearest, Scalp, Through};
        assert_eq!(levels, [Nearest, Nearest, Through, Through, Scalp, Scalp]);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        #[track_caller]
        fn check(change: impl Fn(&mut Gesture), expected: &str) {
            let mut one = gesture(7, Tool::Comb);
            change(&mut one);
            let fault = Gestures(vec![one]).fault().unwrap_or_default();
            assert!(fault.contains(expected), "{fault:?}: expected {expected:?}");
        }
        assert_eq!(Gestures(vec![gesture(7, Tool::Comb)]).fault(), None);
        check(|g| g.id = 0, "gesture 0: its id 0 is 0 or used before");
        check(|g| g.samples.clear(), "gesture 0 (comb): it has no samples");
        check(|g| g.samples[1].at.x = f32::NAN, "sample 1 is not a finite number");
        check(|g| g.samples[1].at.x = 1e6, "sample 1 is 100000 pixels");
        check(|g| g.view.eye = g.view.target, "looks at its own eye");
        check(|g| g.view.up = Vec3::Z, "lies along the view");
        check(|g| g.view.pixels = 0.0, "has no height");
        check(|g| g.view.eye.x = f32::INFINITY, "not on earth");
        check(|g| g.path = vec![Vec3::NAN], "point 0 of its path");
        check(|g| g.strength = -1.0, "its strength -1");
        check(|g| g.colour = Some(Vec3::splat(-1.0)), "its colour");
        let twice = Gestures(vec![gesture(7, Tool::Comb), gesture(7, Tool::Cut)]);
        assert!(twice.fault().unwrap().contains("gesture 1: its id 7"));
    }

    #[test]
    fn every_part_of_a_gesture_is_in_its_key() {
        let changes: &[fn(&mut Gesture)] = &[
            |g| g.id = 8,
            |g| g.tool = Tool::Cut,
            |g| g.layer = Layer::Scalp,
            |g| g.view.eye.x = 1.0,
            |g| g.view.target.x = 1.0,
            |g| g.view.up.x = 0.1,
            |g| g.view.half_height = 0.3,
            |g| g.view.parallel = true,
            |g| g.view.pixels = 900.0,
            |g| g.samples[1].pressure = 0.6,
            |g| g.curves.push(5),
            |g| g.root = Some(Vec3::Y),
            |g| g.path.push(Vec3::Y),
            |g| g.colour = Some(Vec3::ONE),
            |g| g.size = 40.0,
            |g| g.strength = 2.0,
        ];
        let mut keys = std::collections::BTreeSet::from([gesture(7, Tool::Comb).key().0]);
        for (i, change) in changes.iter().enumerate() {
            let mut one = gesture(7, Tool::Comb);
            change(&mut one);
            assert!(keys.insert(one.key().0), "change {i}");
        }
    }

    #[test]
    fn the_frame_of_a_root_leads_to_and_fro_and_stands_as_the_head_does() {
        let frame = HeadFrame { radius: 17.8, ..HeadFrame::IDENTITY };
        let at = RootFrame::of(&frame, Vec3::new(0.0, 0.0, 17.8), Vec3::Z);
        // Two head units out and one down: on a head twice as large, 4 cm and 2 cm.
        assert!(at.world(Vec3::new(2.0, 1.0, 0.0)).distance(Vec3::new(0.0, -2.0, 21.8)) < 1e-5);
        for p in [Vec3::new(0.3, -2.0, 7.0), Vec3::splat(-4.0)] {
            assert!(at.world(at.local(p)).distance(p) < 1e-4);
        }
        // On the crown, down is forward.
        let crown = RootFrame::of(&frame, Vec3::Y * 17.8, Vec3::Y);
        assert!(crown.world(Vec3::Y).distance(Vec3::new(0.0, 17.8, 2.0)) < 1e-5);
    }
}
