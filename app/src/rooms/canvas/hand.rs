//! What the hand holds on the canvas: a wire's end, a bend, a frame, a knife. And what it aims at.

use super::edits;
use super::finder::short_name;
use super::node::End;
use super::wires::Wire;
use crate::core::faces::{Face, Faces, Plug, comes_by_wire};
use coif_graphs::document::edit::Edit;
use coif_graphs::document::wiring::{self, LooseWire};
use coif_graphs::document::{Document, NodeId, Socket};
use egui::{Pos2, Rect, Vec2};
use std::collections::{BTreeMap, BTreeSet};

/// How near to a socket a wire's end is drawn to it, in points of the screen.
const REACH: f32 = 16.0;

/// What the hand holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum Hand {
    /// Nothing.
    #[default]
    Empty,
    /// The loose end of a wire.
    Wire(Loose),
    /// A knife, drawn along these places.
    Cut(Vec<Pos2>),
    /// A bend of a wire: all its bends as they would be.
    Bend {
        /// Whose.
        wire: Wire,
        /// Which.
        number: usize,
        /// All of them.
        bends: Vec<Pos2>,
    },
    /// A frame, with the nodes in it or by its corner.
    Frame {
        /// Which.
        name: String,
        /// The nodes that go with it; none when only its size changes.
        nodes: Option<BTreeSet<NodeId>>,
        /// How far it was moved.
        by: Vec2,
    },
}

/// A wire with one end loose.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Loose {
    /// The end that is fixed.
    pub fixed: Fixed,
    /// The wire that was lifted off an input.
    pub lifted: Option<Wire>,
    /// Whether a button is held; else it was picked up by a click and is put down by one.
    pub held: bool,
}

/// The end of a loose wire that stays.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fixed {
    /// An output; the wire looks for an input.
    Output(Socket),
    /// An input; the wire looks for an output.
    Input(Plug),
    /// The inputs of all wires of an output; they look for another output.
    Bundle(Socket, Vec<Wire>),
}

/// What a loose wire aims at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Aim {
    /// Whose end.
    pub node: NodeId,
    /// Which end; none where the wire points at the node alone, and not just one end that is drawn takes it.
    pub end: Option<End>,
    /// Why it cannot be wired there.
    pub refused: Option<String>,
}

impl Loose {
    /// What is aimed at from a place of the canvas. `scale` is points of the screen for a unit; `open` is a node that lies over others.
    pub(super) fn aim(
        &self,
        document: &Document,
        (faces, corners): (&Faces, &BTreeMap<NodeId, Pos2>),
        open: Option<&NodeId>,
        at: Pos2,
        scale: f32,
    ) -> Option<Aim> {
        let reach = REACH / scale.max(0.01);
        let mut best: Option<(f32, &Face, End)> = None;
        let over = node_at(faces, corners, open, at);
        let covers = |face: &Face| open != Some(&face.id) && open.is_some() && over == open;
        for (face, corner) in faces.all.values().filter_map(|f| Some((f, *corners.get(&f.id)?))) {
            if covers(face) {
                continue;
            }
            let near = Rect::from_min_size(corner, face.size()).expand(reach);
            if !near.contains(at) {
                continue;
            }
            for (end, place) in self.ends(face, corner) {
                let distance = place.distance(at);
                if distance <= reach && best.is_none_or(|(nearest, ..)| distance < nearest) {
                    best = Some((distance, face, end));
                }
            }
        }
        let loose = self.wire(document);
        let refused = |face: &Face, end: End| self.reason(document, &loose, plug(face, end)?);
        if let Some((_, face, end)) = best {
            return Some(Aim {
                node: face.id.clone(),
                end: Some(end),
                refused: refused(face, end),
            });
        }
        // On a node, but at none of its ends: the end that fits.
        let face = faces.all.get(over?).filter(|face| !self.belongs_to(&face.id))?;
        let node = face.id.clone();
        if let Fixed::Output(_) = self.fixed {
            let taking = self.taking(document, face);
            let end = match &taking[..] {
                [one] => end_of(face, one),
                _ => None,
            };
            let refused = taking.is_empty().then(|| self.why_none(document, face));
            return Some(Aim { node, end, refused });
        }
        let corner = *corners.get(&face.id)?;
        let ends: Vec<End> = self.ends(face, corner).map(|(end, _)| end).collect();
        let fits = |end: &&End| refused(face, **end).is_none();
        let end = *ends.iter().find(fits).or_else(|| ends.first())?;
        Some(Aim { node, end: Some(end), refused: refused(face, end) })
    }

    /// The inputs of a node that take the wire, those that the canvas does not show among them.
    pub(super) fn taking(&self, document: &Document, face: &Face) -> Vec<Socket> {
        let Some(loose) = self.wire(document) else { return vec![] };
        let known = face.def.into_iter().flat_map(|def| def.inputs);
        let known = known.map(|input| Socket::new(face.id.clone(), input.name));
        let shown = face.inputs.iter().map(|plug| plug.socket.clone());
        let mut all: Vec<Socket> = known.collect();
        all.extend(shown.filter(|_| face.def.is_none()));
        all.retain(|socket| loose.reason(socket).is_none());
        all.dedup();
        all
    }

    /// A node with those of its inputs that take the wire and are set otherwise: they are shown while the wire is over it.
    pub(super) fn opens(
        &self,
        document: &Document,
        face: &Face,
    ) -> Option<(NodeId, BTreeSet<Socket>)> {
        if !matches!(self.fixed, Fixed::Output(_)) || self.belongs_to(&face.id) || face.collapsed {
            return None;
        }
        let by_wire = |socket: &Socket| {
            wiring::input_def(document, socket).is_none_or(|input| comes_by_wire(input.ty))
        };
        let taking = self.taking(document, face).into_iter();
        let inputs: BTreeSet<Socket> = taking.filter(|socket| !by_wire(socket)).collect();
        (!inputs.is_empty()).then(|| (face.id.clone(), inputs))
    }

    /// Why no input of a node takes the wire: what is wrong with the first of its type, else that there is none.
    fn why_none(&self, document: &Document, face: &Face) -> String {
        let Fixed::Output(from) = &self.fixed else { return String::new() };
        let given = wiring::output_type(document, from);
        let of_type = face.def.zip(given).and_then(|(def, ty)| wiring::taking(def, ty));
        let loose = LooseWire::from_output(document, from.clone());
        let why = of_type.and_then(|it| loose.reason(&Socket::new(face.id.clone(), it.name)));
        why.unwrap_or_else(|| {
            format!("{} takes no {}", face.label, given.map_or("such thing", short_name))
        })
    }

    /// The ends of a node that the wire could go to, and where they are.
    fn ends<'a>(&self, face: &'a Face, corner: Pos2) -> impl Iterator<Item = (End, Pos2)> + 'a {
        let to_input = matches!(self.fixed, Fixed::Output(_));
        let inputs = if to_input { face.inputs.len() } else { 0 };
        let outputs = if to_input { 0 } else { face.outputs.len() };
        let inputs = (0..inputs).map(move |n| (End::In(n), face.input_at(corner, n)));
        inputs.chain((0..outputs).map(move |n| (End::Out(n), face.output_at(corner, n))))
    }

    fn wire<'a>(&self, document: &'a Document) -> Option<LooseWire<'a>> {
        match &self.fixed {
            Fixed::Output(from) => Some(LooseWire::from_output(document, from.clone())),
            Fixed::Input(plug) => Some(LooseWire::from_input(document, plug.socket.clone())),
            Fixed::Bundle(..) => None,
        }
    }

    fn reason(
        &self,
        document: &Document,
        loose: &Option<LooseWire<'_>>,
        plug: &Plug,
    ) -> Option<String> {
        match (&self.fixed, loose) {
            (Fixed::Bundle(from, _), _) if plug.socket == *from => None,
            (Fixed::Bundle(_, wires), _) => edits::rewire(document, wires, &plug.socket).err(),
            (_, Some(loose)) => loose.reason(&plug.socket),
            _ => None,
        }
    }

    fn belongs_to(&self, node: &NodeId) -> bool {
        match &self.fixed {
            Fixed::Output(from) | Fixed::Bundle(from, _) => from.node == *node,
            Fixed::Input(plug) => plug.socket.node == *node,
        }
    }

    /// The edit of putting the wire down at what it aims at; none when nothing would change.
    ///
    /// # Errors
    /// Why it cannot be put down there.
    pub(super) fn put_down(
        &self,
        document: &Document,
        faces: &Faces,
        aim: &Aim,
    ) -> Result<Option<Edit>, String> {
        if let Some(why) = &aim.refused {
            return Err(why.clone());
        }
        let face = faces.all.get(&aim.node);
        let Some(plug) = face.zip(aim.end).and_then(|(face, end)| plug(face, end)) else {
            return Ok(None);
        };
        match &self.fixed {
            Fixed::Output(from) => Ok(edits::connect(document, from, plug, self.lifted.as_ref())),
            Fixed::Input(to) => Ok(edits::connect(document, &plug.socket, to, None)),
            Fixed::Bundle(from, _) if *from == plug.socket => Ok(None),
            Fixed::Bundle(_, wires) => edits::rewire(document, wires, &plug.socket).map(Some),
        }
    }
}

/// The node at a place of the canvas: one that lies over others before these.
pub(super) fn node_at<'a>(
    faces: &'a Faces,
    corners: &BTreeMap<NodeId, Pos2>,
    open: Option<&'a NodeId>,
    at: Pos2,
) -> Option<&'a NodeId> {
    let under = |id: &&NodeId| {
        let (face, corner) = (faces.all.get(*id), corners.get(*id));
        face.zip(corner).is_some_and(|(f, c)| Rect::from_min_size(*c, f.size()).contains(at))
    };
    open.filter(under).or_else(|| faces.all.keys().rfind(under))
}

/// The end of a node at which a wire into an input goes: a free one, else one that has a wire already.
fn end_of(face: &Face, input: &Socket) -> Option<End> {
    let mut plugs = face.inputs.iter().enumerate().filter(|(_, plug)| plug.socket == *input);
    let first = plugs.clone().next();
    plugs.find(|(_, plug)| plug.wire.is_none()).or(first).map(|(number, _)| End::In(number))
}

/// The plug of an input, also of one that the canvas does not show.
pub(super) fn plug_of(document: &Document, face: &Face, input: &Socket) -> Plug {
    let shown = end_of(face, input).and_then(|end| plug(face, end));
    shown.cloned().unwrap_or_else(|| Plug {
        socket: input.clone(),
        ty: wiring::input_def(document, input).map(|input| input.ty),
        wire: None,
        many: false,
        needed: false,
    })
}

/// An end's plug.
pub(super) fn plug(face: &Face, end: End) -> Option<&Plug> {
    match end {
        End::In(number) => face.inputs.get(number),
        End::Out(number) => face.outputs.get(number),
    }
}

/// What is picked up at an end of a node: a wired input's wire at its far end, else a new one. With
/// `all`, every wire of an output, or a new wire from a wired input.
pub(super) fn pick_up(
    document: &Document,
    face: &Face,
    end: End,
    all: bool,
    held: bool,
) -> Option<Loose> {
    let plug = plug(face, end)?;
    let new = |fixed| Loose { fixed, lifted: None, held };
    match end {
        End::Out(_) => {
            let wires = super::wires::of_output(document, &plug.socket);
            if all && !wires.is_empty() {
                return Some(new(Fixed::Bundle(plug.socket.clone(), wires)));
            }
            Some(new(Fixed::Output(plug.socket.clone())))
        }
        End::In(_) => match plug.wire.map(|at| Wire { to: plug.socket.clone(), at }) {
            Some(wire) if !all => {
                let from = wire.from(document)?.clone();
                Some(Loose { fixed: Fixed::Output(from), lifted: Some(wire), held })
            }
            _ => Some(new(Fixed::Input(plug.clone()))),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rooms::canvas::testing::{document, faces, id, socket};
    use egui::vec2;

    fn aim(document: &Document, loose: &Loose, node: &str, off: Vec2) -> Option<Aim> {
        let faces = faces(document);
        let at = faces.corners[node] + off;
        loose.aim(document, (&faces, &faces.corners), None, at, 1.0)
    }
    fn input(document: &Document, input: &str) -> (Faces, usize) {
        let socket = socket(input);
        let faces = faces(document);
        let number = faces.all[&socket.node].inputs.iter().position(|p| p.socket == socket);
        (faces, number.unwrap())
    }

    #[test]
    fn a_wired_input_gives_its_wire_and_a_free_one_a_new_wire() {
        let document = document("cornrows");
        let (faces, number) = input(&document, "fill.curves");
        let face = &faces.all["fill"];
        let lifted = pick_up(&document, face, End::In(number), false, true).unwrap();
        assert_eq!(lifted.fixed, Fixed::Output(socket("braid.curves")));
        assert_eq!(lifted.lifted, Some(Wire { to: socket("fill.curves"), at: 0 }));
        let fresh = pick_up(&document, face, End::In(number), true, true).unwrap();
        assert!(matches!(fresh.fixed, Fixed::Input(_)));
        let all = pick_up(&document, &faces.all["rows"], End::Out(0), true, true).unwrap();
        assert!(matches!(all.fixed, Fixed::Bundle(_, wires) if wires.len() == 2));
    }

    #[test]
    fn the_hand_aims_at_the_nearest_end_and_says_why_not() {
        let document = document("cornrows");
        let loose =
            Loose { fixed: Fixed::Output(socket("braid.curves")), lifted: None, held: true };
        let (faces, number) = input(&document, "fill.curves");
        let at = faces.all["fill"].input_at(Pos2::ZERO, number).to_vec2();
        let hit = aim(&document, &loose, "fill", at + vec2(-9.0, 3.0)).unwrap();
        assert_eq!((hit.node, hit.end, hit.refused), (id("fill"), Some(End::In(number)), None));
        let scalp =
            faces.all["fill"].inputs.iter().position(|p| &*p.socket.name == "scalp").unwrap();
        let at = faces.all["fill"].input_at(Pos2::ZERO, scalp).to_vec2();
        let wrong = aim(&document, &loose, "fill", at).unwrap();
        assert!(wrong.refused.is_some_and(|why| why.contains("scalp")));
        // Rows feed the braid: a wire back would run in a circle.
        let circle = aim(&document, &loose, "braid", vec2(60.0, 10.0));
        assert_eq!(circle, None, "its own node is no aim");
        let back = aim(&document, &loose, "partings", vec2(60.0, 10.0)).unwrap();
        assert_eq!((back.end, back.refused), (None, None), "several take it");
        assert_eq!(aim(&document, &loose, "head", vec2(-400.0, 900.0)), None);
    }

    #[test]
    fn a_refused_end_changes_nothing() {
        let document = document("cornrows");
        let faces = faces(&document);
        let loose = Loose { fixed: Fixed::Output(socket("fill.curves")), lifted: None, held: true };
        let at = faces.corners["braid"] + vec2(60.0, 10.0);
        let aim = loose.aim(&document, (&faces, &faces.corners), None, at, 1.0).unwrap();
        let why = loose.put_down(&document, &faces, &aim).unwrap_err();
        assert!(why.contains("circle"), "{why}");
    }
}
