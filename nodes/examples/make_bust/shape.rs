//! The sculpture: a signed field whose zero surface is the bust, negative inside, in centimetres.
//!
//! Built as a modeller would: lofted masses (skull, face, neck, chest), clay added and taken away with
//! soft brushes, then nose, lips, lids and ears set on. Guarantees: mirror-symmetric in x, a pure
//! function of the point. It is no true distance: use steps shorter than its value.

use crate::vector::{V, blend, both, ellipsoid, refine, step, through, tube, v};

/// Clay put on (positive) or taken off along a path, fading over `width`; nothing outside `low` to `high`.
struct Stroke {
    path: Vec<(V, f64)>,
    width: f64,
    low: V,
    high: V,
}

/// One dab of clay.
struct Dab {
    at: V,
    size: V,
    amount: f64,
}

/// The bust.
pub struct Bust {
    strokes: Vec<Stroke>,
    dabs: Vec<Dab>,
    late: Vec<Stroke>,
    helix: Vec<(V, f64)>,
    antihelix: Vec<(V, f64)>,
    crus: Vec<(V, f64)>,
    nose: Vec<(V, f64)>,
}

fn stroke(width: f64, path: &[(f64, f64, f64, f64)]) -> Stroke {
    let path: Vec<(V, f64)> = path.iter().map(|q| (v(q.0, q.1, q.2), q.3)).collect();
    let path = refine(&path, 3);
    let m = width * 3.0;
    let edge = |f: fn(f64, f64) -> f64, s: f64, m: f64| {
        v(
            path.iter().map(|q| q.0.x).fold(s, f) + m,
            path.iter().map(|q| q.0.y).fold(s, f) + m,
            path.iter().map(|q| q.0.z).fold(s, f) + m,
        )
    };
    let (low, high) = (edge(f64::min, 1e9, -m), edge(f64::max, -1e9, m));
    Stroke { path, width, low, high }
}

impl Stroke {
    fn at(&self, p: V) -> f64 {
        if p.x < self.low.x
            || p.y < self.low.y
            || p.z < self.low.z
            || p.x > self.high.x
            || p.y > self.high.y
            || p.z > self.high.z
        {
            return 0.0;
        }
        let (mut best, mut amount) = (1e9, 0.0);
        for w in self.path.windows(2) {
            let (a, b) = (w[0].0, w[1].0);
            let ab = b - a;
            let t = ((p - a).dot(ab) / ab.dot(ab)).clamp(0.0, 1.0);
            let e = p - a - ab * t;
            let e = e.dot(e);
            if e < best {
                best = e;
                amount = w[0].1 + (w[1].1 - w[0].1) * t;
            }
        }
        amount * (-best / (self.width * self.width)).exp()
    }
}

fn dab(at: (f64, f64, f64), size: (f64, f64, f64), amount: f64) -> Dab {
    Dab { at: v(at.0, at.1, at.2), size: v(size.0, size.1, size.2), amount }
}

/// The middle of the eyeball, and its radius.
pub const EYE: V = v(3.12, -2.95, 6.78);
pub const EYE_R: f64 = 1.22;
/// Where the ear sits: just above its bowl's notch.
pub const EAR: V = v(6.80, -4.45, -0.45);
const FISSURE: f64 = 1.42;
/// The part of the eyeball that shows is wider than a ball, so that the corners of the lids close on it.
const BALL: V = v(1.50, EYE_R, EYE_R);

/// A horizontal ellipse that changes with height: half width, front and back.
fn loft(p: V, half: f64, front: f64, back: f64) -> f64 {
    let (zc, zr) = ((front + back) / 2.0, (front - back) / 2.0);
    let q = v(p.x / half, (p.z - zc) / zr, 0.0);
    let l = q.length();
    let g = v(q.x / half, q.y / zr, 0.0).length();
    if g < 1e-9 { -half.min(zr) } else { l * (l - 1.0) / g }
}

impl Bust {
    pub fn new() -> Self {
        let dabs = vec![
            // Skull: back of the head fuller above, the occiput, parietal eminences, brow, temples.
            dab((0.0, -1.0, -9.6), (4.8, 3.4, 4.0), 0.32),
            dab((0.0, 5.0, -7.0), (5.0, 4.0, 4.5), 0.25),
            dab((7.2, -0.8, -2.0), (3.0, 2.6, 5.5), 0.16),
            dab((5.6, 4.4, -3.5), (3.2, 3.2, 4.0), 0.30),
            dab((2.8, 4.2, 7.4), (3.4, 3.0, 3.2), 0.22),
            dab((6.6, -0.6, 5.0), (2.0, 2.8, 2.4), -0.22),
            // Orbits.
            dab((3.0, -2.7, 8.4), (1.9, 1.22, 1.5), -0.76),
            dab((1.75, -2.85, 8.4), (0.8, 0.9, 1.3), -0.40),
            dab((3.3, -1.8, 7.9), (1.6, 0.6, 1.0), 0.16),
            // Cheeks: body of the cheekbone, hollow below, pad beside the mouth.
            dab((4.2, -5.0, 6.9), (2.0, 1.6, 2.4), 0.36),
            dab((6.4, -4.4, 3.0), (1.5, 1.3, 2.8), 0.18),
            dab((5.4, -8.0, 4.0), (2.2, 2.2, 2.8), -0.10),
            dab((3.2, -6.6, 7.8), (1.8, 1.8, 2.0), 0.22),
            dab((4.6, -6.9, 6.0), (2.2, 2.3, 2.6), 0.24),
            // The mound of the teeth, the fold under the lip, the chin.
            dab((0.0, -9.3, 8.8), (2.7, 1.8, 2.4), 0.52),
            dab((0.0, -11.25, 9.0), (1.9, 0.75, 1.2), -0.28),
            dab((0.0, -12.7, 8.4), (1.5, 1.1, 1.5), 0.34),
            dab((2.6, -9.6, 8.2), (0.65, 0.6, 0.9), -0.10),
            // In front of the ear.
            dab((6.5, -5.2, 0.9), (0.9, 2.0, 1.2), 0.22),
            // Angle of the jaw.
            dab((5.2, -9.6, 0.8), (1.3, 1.4, 1.6), 0.32),
            dab((3.9, -12.0, 1.9), (1.6, 1.2, 1.8), 0.55),
            // Windpipe, pit of the neck, hollows above the collarbones, breast muscles.
            dab((0.0, -17.2, 4.0), (1.1, 1.6, 2.0), 0.30),
            dab((0.0, -21.0, 3.2), (1.4, 1.2, 1.6), -0.45),
            dab((6.8, -20.4, 0.2), (2.8, 1.1, 1.8), -0.80),
            dab((7.5, -27.0, 6.0), (4.5, 3.2, 4.0), 0.45),
            dab((0.0, -26.0, 7.0), (0.9, 4.0, 3.0), -0.22),
            // Shoulder blades and the furrow of the spine.
            dab((7.2, -25.5, -11.5), (2.8, 3.6, 3.0), 0.26),
            dab((0.0, -24.0, -12.5), (1.2, 4.0, 2.5), -0.30),
            // Nape: the hollow between the two cords.
            dab((0.0, -9.5, -8.0), (1.3, 3.4, 2.0), -0.30),
            dab((2.3, -10.0, -7.2), (1.5, 4.0, 2.0), 0.22),
            dab((0.0, -18.2, -9.6), (1.3, 1.4, 1.5), 0.22),
        ];
        let strokes = vec![
            // Brow ridge.
            stroke(
                0.9,
                &[
                    (0.4, -1.2, 9.1, 0.08),
                    (1.4, -0.90, 9.0, 0.14),
                    (2.8, -0.65, 8.5, 0.20),
                    (4.4, -0.85, 7.2, 0.24),
                    (5.3, -2.0, 5.8, 0.20),
                ],
            ),
            // Outer rim of the orbit and lower rim.
            stroke(
                0.7,
                &[
                    (5.3, -2.0, 5.8, 0.18),
                    (5.2, -3.3, 5.9, 0.25),
                    (4.4, -4.3, 7.0, 0.16),
                    (3.0, -4.6, 7.9, 0.08),
                ],
            ),
            // Cheek arch towards the ear.
            stroke(1.1, &[(5.0, -4.7, 5.9, 0.08), (6.3, -4.3, 3.4, 0.09), (6.9, -4.0, 0.8, 0.08)]),
            // Edge of the jaw.
            stroke(
                0.9,
                &[
                    (5.2, -8.2, 0.2, 0.1),
                    (5.1, -10.2, 1.2, 0.26),
                    (4.2, -11.7, 4.0, 0.24),
                    (2.4, -13.0, 6.9, 0.16),
                ],
            ),
            // Neck muscle from behind the ear to the breastbone.
            stroke(
                1.0,
                &[
                    (6.1, -7.0, -3.0, 0.35),
                    (5.6, -12.0, -1.6, 0.45),
                    (3.8, -17.0, 1.2, 0.46),
                    (1.5, -21.2, 2.8, 0.28),
                ],
            ),
            // Collarbones.
            stroke(
                0.75,
                &[
                    (1.4, -21.8, 3.0, 0.36),
                    (4.5, -21.6, 3.2, 0.42),
                    (9.0, -21.3, 1.4, 0.4),
                    (12.5, -21.4, -1.2, 0.35),
                    (15.5, -21.8, -3.0, 0.05),
                ],
            ),
            // Fold from the wing of the nose to the corner of the mouth.
            stroke(
                0.6,
                &[(1.85, -6.9, 8.9, -0.10), (2.5, -8.0, 8.5, -0.10), (3.0, -9.2, 8.0, -0.04)],
            ),
        ];
        let late = vec![
            // Groove of the upper lip with its two ridges.
            stroke(
                0.26,
                &[(0.0, -7.3, 9.7, -0.07), (0.0, -8.1, 9.7, -0.15), (0.0, -8.7, 9.9, -0.10)],
            ),
            stroke(
                0.22,
                &[(0.32, -7.4, 9.7, 0.02), (0.45, -8.1, 9.7, 0.08), (0.55, -8.65, 9.9, 0.06)],
            ),
            // Crease above the wing of the nose.
            stroke(
                0.20,
                &[
                    (0.90, -5.85, 10.3, -0.01),
                    (1.25, -5.95, 9.9, -0.08),
                    (1.65, -6.3, 9.2, -0.12),
                    (1.78, -7.0, 8.8, -0.10),
                ],
            ),
        ];
        let nose = refine(
            &[
                (v(0.0, -1.9, 8.15), 0.70),
                (v(0.0, -2.9, 8.35), 0.58),
                (v(0.0, -4.3, 9.25), 0.62),
                (v(0.0, -5.4, 9.95), 0.62),
                (v(0.0, -6.32, 10.45), 0.84),
            ],
            3,
        );
        let e = |u: f64, w: f64, o: f64, r: f64| (v(u, w, o), r);
        let helix = refine(
            &[
                e(1.10, -0.30, -0.50, 0.20),
                e(0.72, -0.02, -0.18, 0.21),
                e(0.30, 0.35, 0.16, 0.22),
                e(0.12, 1.15, 0.36, 0.24),
                e(0.42, 2.15, 0.48, 0.26),
                e(1.20, 2.82, 0.52, 0.28),
                e(2.15, 2.70, 0.50, 0.28),
                e(2.90, 1.95, 0.46, 0.27),
                e(3.15, 0.85, 0.40, 0.25),
                e(2.98, -0.30, 0.32, 0.23),
                e(2.55, -1.30, 0.24, 0.22),
                e(1.98, -2.10, 0.14, 0.24),
                e(1.35, -2.60, 0.06, 0.30),
                e(0.75, -2.55, 0.00, 0.30),
            ],
            9,
        );
        let antihelix = refine(
            &[
                e(0.75, -1.55, 0.28, 0.22),
                e(1.25, -1.50, 0.36, 0.26),
                e(1.80, -1.05, 0.38, 0.26),
                e(2.15, -0.20, 0.42, 0.30),
                e(2.12, 0.70, 0.42, 0.32),
                e(1.75, 1.55, 0.34, 0.30),
                e(1.36, 2.05, 0.20, 0.22),
            ],
            9,
        );
        let crus = refine(
            &[e(2.05, 0.75, 0.38, 0.26), e(1.45, 1.05, 0.28, 0.22), e(0.75, 1.20, 0.14, 0.16)],
            9,
        );
        Self { strokes, dabs, late, helix, antihelix, crus, nose }
    }

    /// Skull, face, neck and chest before any brush.
    fn masses(&self, p: V) -> f64 {
        // Seen from above a little squarer than an ellipse.
        let q = p - v(0.0, 0.15, -0.40);
        let (a, b) = ((q.x / 7.70).abs(), (q.z / 9.50).abs());
        let round =
            (a.powf(2.16) + b.powf(2.16)).powf(1.0 / 2.16) / (a * a + b * b).sqrt().max(1e-9);
        let cranium =
            ellipsoid(v(q.x * round, q.y, q.z * round), v(0.0, 0.0, 0.0), v(7.70, 8.90, 9.50));
        // The face: ellipses by height, cut below by the plane of the jaw and behind by its branch.
        let half = through(
            &[
                (-15.0, 2.6),
                (-13.5, 3.4),
                (-11.5, 4.72),
                (-9.4, 5.75),
                (-7.0, 6.45),
                (-4.5, 6.80),
                (-1.5, 6.75),
                (1.5, 6.2),
                (4.0, 5.2),
            ],
            p.y,
        );
        let front = through(
            &[
                (-15.0, 8.0),
                (-13.6, 8.55),
                (-12.3, 8.75),
                (-11.0, 8.75),
                (-9.4, 8.95),
                (-7.2, 9.15),
                (-5.0, 8.95),
                (-3.0, 8.75),
                (-1.0, 9.05),
                (1.0, 8.95),
                (4.0, 7.4),
            ],
            p.y,
        );
        let back =
            through(&[(-15.0, -0.5), (-12.0, -3.5), (-9.0, -5.5), (-4.0, -5.0), (4.0, -5.0)], p.y);
        let mut face = loft(p, half, front, back);
        let jaw = -(p - v(0.0, -14.05, 7.6)).dot(v(0.0, 0.90, 0.435));
        face = both(face, jaw, 3.2);
        face = both(face, -0.15 - p.z - (p.y + 9.0) * 0.18, 2.4);
        face = both(face, p.y - 3.5, 3.0);
        let mut d = blend(cranium, face, 2.2);
        // The floor of the mouth between the two halves of the jaw.
        d = blend(d, ellipsoid(p, v(0.0, -11.6, 4.0), v(3.4, 2.1, 3.9)), 1.6);
        // Neck.
        let half = through(
            &[
                (-26.0, 8.2),
                (-22.0, 7.0),
                (-19.0, 6.0),
                (-16.0, 5.35),
                (-13.0, 5.2),
                (-10.0, 5.35),
                (-7.0, 5.5),
                (-4.0, 5.0),
            ],
            p.y,
        );
        let front = through(
            &[
                (-26.0, 3.6),
                (-22.0, 2.7),
                (-19.0, 2.6),
                (-16.0, 2.9),
                (-14.0, 3.2),
                (-11.0, 3.4),
                (-6.0, 2.0),
            ],
            p.y,
        );
        let back = through(
            &[
                (-26.0, -12.4),
                (-22.0, -11.8),
                (-18.0, -9.6),
                (-15.0, -8.0),
                (-12.0, -7.15),
                (-9.5, -7.1),
                (-7.0, -7.6),
                (-4.0, -8.2),
            ],
            p.y,
        );
        let neck = both(loft(p, half, front, back), p.y + 4.5, 3.0);
        d = blend(d, neck, 2.4);
        // Chest, shoulders and the slope of the trapezius.
        let chest = ellipsoid(p, v(0.0, -33.0, -3.2), v(18.5, 12.6, 10.4));
        // Paired masses meet the midline without a crease.
        let p = v((p.x * p.x + 0.8).sqrt(), p.y, p.z);
        let shoulder = tube(
            p,
            &[
                (v(8.0, -26.4, -3.6), 4.6),
                (v(15.2, -26.5, -4.0), 4.35),
                (v(16.6, -29.0, -3.8), 4.2),
            ],
            2.0,
        );
        let trapezius = tube(
            p,
            &[
                (v(3.2, -15.0, -5.4), 1.6),
                (v(5.0, -19.2, -5.9), 2.3),
                (v(9.5, -22.2, -5.6), 2.1),
                (v(15.0, -23.6, -4.4), 1.6),
            ],
            2.0,
        );
        let mut body = blend(chest, shoulder, 4.0);
        body = blend(body, trapezius, 4.0);
        d = blend(d, body, 3.2);
        d
    }

    /// Height of the line between the lips.
    fn mouth_line(x: f64) -> f64 {
        let s = (x / 2.38).min(1.0);
        -9.45 - 0.05 * (-(x / 0.4) * (x / 0.4)).exp() + 0.24 * (1.0 - s) * s - 0.08 * s * s
    }

    /// Lip relief over the face: (height, true lip surface where > 0).
    fn lips(&self, p: V) -> (f64, f64) {
        if p.z < 6.5 || p.y > -7.6 || p.y < -11.6 || p.x > 3.4 {
            return (0.0, -1.0);
        }
        let x = p.x;
        let s = (x / 2.38).min(1.0);
        let line = Self::mouth_line(x);
        let top = through(
            &[
                (0.0, -8.80),
                (0.25, -8.765),
                (0.55, -8.70),
                (0.85, -8.73),
                (1.4, -8.90),
                (1.9, -9.22),
                (2.38, -9.50),
            ],
            x,
        );
        let low = through(
            &[
                (0.0, -10.42),
                (0.6, -10.40),
                (1.2, -10.25),
                (1.8, -9.98),
                (2.2, -9.68),
                (2.38, -9.56),
            ],
            x,
        );
        let full = (1.0 - s * s).max(0.0).sqrt();
        let mut h = 0.0;
        let above = (p.y - line) / (top - line).max(0.02);
        let below = (line - p.y) / (line - low).max(0.02);
        let roll = |t: f64| {
            if t < 0.0 {
                0.0
            } else {
                (t / 0.42).min(1.0) * (2.0 - (t / 0.42).min(1.0)) * (1.0 - step(0.35, 1.30, t))
            }
        };
        h += 0.23 * full * roll(above);
        h += 0.29 * full * roll(below);
        // The slit between the lips.
        h -= 0.12
            * (0.25 + 0.75 * full)
            * (-((p.y - line) / 0.17) * ((p.y - line) / 0.17)).exp()
            * (1.0 - step(2.2, 2.65, x));
        let inside = (top - p.y).min(p.y - low).min((2.38 - x) * 0.5);
        (h, inside)
    }

    /// Upper and lower edge of the open lids at `t`, the sideways distance from the eye's middle.
    fn lids(t: f64) -> (f64, f64) {
        let s = t / FISSURE;
        let q = 1.0 - s * s;
        let tilt = 0.09 * s;
        if q <= 0.0 {
            return (tilt + q * 0.5, tilt - q * 0.5);
        }
        let up = 0.50 * q.powf(0.72) * (1.0 - 0.10 * s) + tilt;
        let down = -0.41 * q.powf(0.85) * (1.0 + 0.15 * s) + tilt;
        (up, down)
    }

    /// Backward along the ear, up along it, and out of its bowl.
    pub fn ear_frame() -> (V, V, V) {
        let up = v(0.11, 0.975, -0.20).unit();
        let back = v(0.46, -0.25, -0.853);
        let back = (back - up * back.dot(up)).unit();
        (back, up, back.cross(up))
    }

    /// The ear alone, in its own frame.
    fn ear(&self, p: V) -> f64 {
        let (back, up, out) = Self::ear_frame();
        let q = p - EAR;
        // Modelled a little small.
        let q = v(q.dot(back), q.dot(up), q.dot(out)) * (1.0 / 1.03);
        if q.x < -2.5 || q.x > 5.0 || q.y.abs() > 5.0 || q.z.abs() > 4.0 {
            return 1.0 + (q.length() - 4.0).max(0.0) * 0.5;
        }
        // The sheet inside the rim.
        let sheet = {
            let upper = ellipsoid(v(q.x, q.y, 0.0), v(1.6, 1.0, 0.0), v(1.55, 1.85, 1.0));
            let lower = ellipsoid(v(q.x, q.y, 0.0), v(1.35, -0.9, 0.0), v(1.35, 1.75, 1.0));
            let outline = blend(upper, lower, 0.8);
            let bend = 0.10 + 0.06 * q.x;
            both(outline, (q.z - bend).abs() - 0.17, 0.2)
        };
        let lobe = ellipsoid(q, v(0.98, -2.30, 0.06), v(0.80, 0.88, 0.36));
        let mut d = blend(sheet, lobe, 0.35);
        // The bowl's wall behind, which joins the head.
        let inner = ellipsoid(q, v(0.55, -0.15, -1.1), v(1.25, 1.75, 0.9));
        d = blend(d, inner, 0.6);
        let wall = ellipsoid(q, v(1.0, -0.25, -0.48), v(1.40, 1.85, 0.80));
        d = blend(d, wall, 0.7);
        // Root of the rim, down its front on to the head.
        let root = tube(
            q,
            &[
                (v(0.22, 1.5, -0.20), 0.30),
                (v(0.02, 0.6, -0.15), 0.38),
                (v(0.02, -0.8, -0.3), 0.40),
                (v(0.35, -1.4, -0.6), 0.36),
            ],
            0.0,
        );
        d = blend(d, root, 0.4);
        d = blend(d, tube(q, &self.antihelix, 0.0), 0.22);
        d = blend(d, tube(q, &self.crus, 0.0), 0.2);
        let bowl = ellipsoid(q, v(1.15, -0.30, 0.15), v(0.78, 1.12, 0.72));
        d = both(d, -bowl, 0.22);
        let shell = ellipsoid(q, v(0.95, 0.75, 0.30), v(0.62, 0.35, 0.40));
        d = both(d, -shell, 0.2);
        let canal = ellipsoid(q, v(0.45, -0.55, -0.4), v(0.32, 0.36, 0.7));
        d = both(d, -canal, 0.15);
        d = blend(d, tube(q, &self.helix, 0.0), 0.14);
        let tragus = ellipsoid(q, v(0.16, -0.65, 0.30), v(0.26, 0.48, 0.24));
        d = blend(d, tragus, 0.25);
        let anti = ellipsoid(q, v(0.95, -1.55, 0.30), v(0.38, 0.24, 0.22));
        blend(d, anti, 0.2)
    }

    /// The side x >= 0, with the face moved up a little as one piece: the eyes belong half-way between crown
    /// and chin, and it is easier to move a finished face than all of its numbers.
    fn place(p: V) -> V {
        let face = step(0.0, 6.0, p.z) * (1.0 - step(-1.5, 4.0, p.y)) * step(-20.0, -14.0, p.y);
        v(p.x.abs(), p.y - 0.24 * face, p.z)
    }

    /// The field; a level that is positive on the eyeball and zero where the lids meet it; and one that is
    /// positive on the base and zero along its rim.
    fn full(&self, p: V) -> (f64, f64, f64) {
        let p = Self::place(p);
        let mut d = self.masses(p);
        let mut eye = -1.0;
        // Far from the surface the brushes cannot matter.
        if d > 4.0 {
            return (d - 2.0, eye, -1.0);
        }
        let mut clay = 0.0;
        for b in &self.dabs {
            let q = (p - b.at).over(b.size);
            let e = q.dot(q);
            if e < 9.0 {
                clay += b.amount * (-e).exp();
            }
            if b.at.x > 0.0 && p.x < 3.0 * b.size.x {
                let q = (v(-p.x, p.y, p.z) - b.at).over(b.size);
                let e = q.dot(q);
                if e < 9.0 {
                    clay += b.amount * (-e).exp();
                }
            }
        }
        for s in &self.strokes {
            clay += s.at(p);
        }
        d -= clay;
        let face = p.z > 4.0 && p.y < 0.5 && p.y > -12.0;
        if face {
            // Nose.
            let mut nose = tube(p, &self.nose, 0.0);
            // Side walls down to the wings, the two domes of the tip, the wings.
            let m = v((p.x * p.x + 0.02).sqrt(), p.y, p.z);
            let wall = tube(
                m,
                &[
                    (v(0.30, -2.6, 7.6), 0.50),
                    (v(0.50, -4.3, 8.5), 0.55),
                    (v(0.68, -5.6, 9.2), 0.54),
                    (v(0.90, -6.4, 9.2), 0.50),
                ],
                0.3,
            );
            nose = blend(nose, wall, 1.1);
            nose = blend(nose, ellipsoid(m, v(0.26, -6.42, 10.45), v(0.60, 0.58, 0.74)), 0.5);
            let q = m - v(1.10, -6.56, 9.55);
            let q = v(q.x * 0.92 + q.z * 0.39, q.y, q.z * 0.92 - q.x * 0.39);
            let ala = ellipsoid(q, v(0.0, 0.0, 0.0), v(0.52, 0.66, 0.98));
            nose = blend(nose, ala, 0.8);
            let columella =
                tube(p, &[(v(0.0, -6.85, 10.35), 0.36), (v(0.0, -7.0, 9.6), 0.36)], 0.0);
            nose = blend(nose, columella, 0.35);
            d = blend(d, nose, 1.15);
            for s in &self.late {
                d -= s.at(p);
            }
            let a = v(0.60, -7.42, 9.95);
            let q = p - a;
            // The nostril leans inward to the tip.
            let q = v(q.x * 0.94 + q.z * 0.34, q.y, q.z * 0.94 - q.x * 0.34);
            let nostril = ellipsoid(q, v(0.0, 0.0, 0.0), v(0.27, 0.55, 0.52));
            d = both(d, -nostril, 0.18);
            // Lips.
            d -= self.lips(p).0;
            // Eyes.
            let q = p - EYE;
            if q.length() < 3.5 {
                let lid = ellipsoid(q, v(0.0, 0.0, 0.0), v(1.52, 1.38, 1.40));
                d = blend(d, lid, 0.55);
                let (up, down) = Self::lids(q.x);
                // The crease of the upper lid follows its edge.
                let crease =
                    (q.y - up - 0.36 - 0.05 * (1.0 - (q.x / FISSURE) * (q.x / FISSURE))) / 0.14;
                let fade = 1.0 - step(0.9, 2.0, q.x.abs());
                if q.z > 0.0 {
                    d += 0.12 * fade * (-crease * crease).exp();
                }
                let open = (q.y - up).max(down - q.y) * 0.85;
                let slit = open.max(-q.z);
                d = both(d, -slit, 0.10);
                let ball = ellipsoid(q, v(0.0, 0.0, 0.0), BALL);
                if q.z > 0.0 {
                    eye = d - ball;
                }
                d = blend(d, ball, 0.03);
            }
        }
        if p.x > 3.5 && p.y < 0.5 && p.y > -10.0 && p.z < 4.0 && p.z > -8.0 {
            let e = self.ear(p);
            d = blend(d, e, 0.45);
        }
        // The cut: a level base, and the arms taken off by leaning planes.
        let arm = (p.x - 20.75) * 0.97 + (p.y + 24.5) * -0.20;
        d = both(d, arm, 2.0);
        let base = -27.6 - p.y - d;
        d = both(d, -27.6 - p.y, 0.35);
        (d, eye, base)
    }

    /// The chest without its base, for the rim's edge lengths.
    fn sides(&self, p: V) -> f64 {
        self.masses(p).max((p.x - 20.75) * 0.97 + (p.y + 24.5) * -0.20)
    }

    pub fn at(&self, p: V) -> f64 {
        self.full(p).0
    }

    /// Positive on the lips, zero along their border.
    pub fn lip_level(&self, p: V) -> f64 {
        self.lips(Self::place(p)).1
    }

    /// Positive where the eyeball shows between the lids, zero where they meet it.
    pub fn eye_level(&self, p: V) -> f64 {
        self.full(p).1
    }

    /// Positive on the base, zero along its rim.
    pub fn base_level(&self, p: V) -> f64 {
        self.full(p).2
    }

    /// Positive on the coloured part of the eye and on the lids before it, zero along its rim.
    pub fn iris_level(&self, p: V) -> f64 {
        let q = Self::place(p) - EYE;
        if q.length() > 2.0 || q.z < 0.0 {
            return -1.0;
        }
        let (x, y) = (q.x - 0.02, q.y - 0.05);
        0.57 - (x * x + y * y).sqrt()
    }

    /// Positive above the line between the lips.
    pub fn mouth_level(&self, p: V) -> f64 {
        let p = Self::place(p);
        let x = p.x;
        if p.z < 6.5 || x > 2.6 || p.y < -10.5 { 1.0 } else { p.y - Self::mouth_line(x) }
    }

    /// Smaller than zero on the ear, in near-centimetres beside it.
    pub fn ear_level(&self, p: V) -> f64 {
        self.ear(v(p.x.abs(), p.y, p.z))
    }

    /// The wanted edge length: fine where the form is fine.
    pub fn edge_length(&self, p: V) -> f64 {
        let p = Self::place(p);
        let far = |c: V, s: V| (p - c).over(s).length();
        let mut l = through(
            &[
                (-28.0, 1.15),
                (-23.0, 1.0),
                (-18.0, 0.80),
                (-14.0, 0.62),
                (-9.0, 0.52),
                (10.0, 0.52),
            ],
            p.y,
        );
        if p.z > 0.0 && p.y > -15.0 {
            l = l
                .min(0.30 + 0.10 * (far(v(0.0, -7.0, 9.0), v(5.5, 6.5, 5.0)) - 1.0).max(0.0) * 5.0);
        }
        let near = |c: V, s: V, fine: f64| fine + 0.30 * (far(c, s) - 1.0).max(0.0);
        l = l.min(near(EYE + v(0.0, 0.0, 0.9), v(1.7, 0.95, 1.2), 0.11));
        l = l.min(near(v(0.0, -9.5, 9.0), v(2.7, 1.1, 2.0), 0.15));
        l = l.min(near(v(0.0, -6.9, 9.9), v(1.8, 0.9, 1.5), 0.15));
        l = l.min(near(v(0.0, -5.0, 9.6), v(1.5, 2.6, 1.5), 0.26));
        // The rounded rim of the base, the edges of the lids, the line between the lips.
        if p.y < -25.8 {
            l = l.min(0.36 + 0.30 * (p.y + 27.55).abs() + 0.25 * (-self.sides(p)).max(0.0));
        }
        let q = p - EYE;
        if q.length() < 2.2 && q.z > 0.0 {
            let (up, down) = Self::lids(q.x);
            let off = (q.y - up).abs().min((q.y - down).abs()).max(q.x.abs() - FISSURE);
            l = l.min(0.062 + 0.22 * off.max(0.0));
        }
        if p.z > 7.0 && p.x < 3.0 {
            l = l.min(0.06 + 0.25 * (p.y + 9.45).abs() + 0.3 * (p.x - 2.5).max(0.0));
        }
        let e = self.ear(p);
        if e < 3.0 && p.z < 3.0 {
            l = l.min(0.185 + 0.22 * e.max(0.0));
        }
        l
    }

    pub fn normal(&self, p: V) -> V {
        let e = 2e-4;
        let f = |d: V| self.at(p + d) - self.at(p - d);
        v(f(v(e, 0.0, 0.0)), f(v(0.0, e, 0.0)), f(v(0.0, 0.0, e))).unit()
    }
}
