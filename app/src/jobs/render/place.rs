//! Where a picture is seen from: a view of any head, one that the graph has saved, or what a node gives.

use super::RenderRequest;
use crate::jobs::evaluate::Opened;
use crate::jobs::stop::Stop;
use coif_graphs::document::{NodeId, SavedView, Socket};
use coif_nodes::define::{Type, Value};
use coif_shaders::camera::{self, Camera, Subject, Viewpoint};
use glam::Vec3;

/// Where the picture is seen from.
pub(super) struct ShotView {
    /// As it is called.
    pub(super) name: String,
    seen: Seen,
}

enum Seen {
    /// A view of any head.
    Head(Viewpoint),
    /// A view that the graph has.
    Saved(SavedView),
    /// Filled with what an output gives.
    Close(Socket),
}

impl ShotView {
    /// What a name means in a graph.
    pub(super) fn of(text: &str, opened: &Opened) -> Result<Self, Stop> {
        let fault = |reason: String| Stop::refused(format!("--camera {text}: {reason}"));
        let name = text.to_owned();
        if let Some(view) = Viewpoint::named(text) {
            return Ok(Self { name, seen: Seen::Head(view) });
        }
        if let Some(view) = opened.document.views.get(text) {
            return Ok(Self { name, seen: Seen::Saved(*view) });
        }
        let Some(node) = text.strip_prefix("close:") else {
            let known = Viewpoint::NAMES.join(", ");
            let saved: Vec<&str> = opened.document.views.keys().map(String::as_str).collect();
            let saved = match &saved[..] {
                [] => "the graph has no saved views".to_owned(),
                names => format!("none of the graph's saved views ({})", names.join(", ")),
            };
            return Err(fault(format!("is not one of {known}, close:NODE, and {saved}")));
        };
        let id = NodeId::new(node).map_err(|err| fault(err.to_string()))?;
        let found = opened.document.nodes.get(&id);
        let found = found.ok_or_else(|| fault(format!("there is no node {node:?}")))?;
        let def = opened
            .document
            .def(&id)
            .ok_or_else(|| fault(format!("its kind {:?} is not known", found.kind)))?;
        let output = def.outputs.iter().find(|output| output.ty == Type::Curves);
        let output = output.ok_or_else(|| {
            fault(format!(
                "{} gives no curves that the picture could be filled with",
                def.with_article()
            ))
        })?;
        Ok(Self { name, seen: Seen::Close(Socket::new(id, output.name)) })
    }

    /// The output whose points are looked at, if any.
    pub(super) fn socket(&self) -> Option<&Socket> {
        match &self.seen {
            Seen::Close(socket) => Some(socket),
            Seen::Head(_) | Seen::Saved(_) => None,
        }
    }

    fn focal_mm(&self, asked: &RenderRequest) -> f32 {
        asked.focal_mm.unwrap_or(match &self.seen {
            Seen::Saved(view) => view.focal_mm,
            Seen::Head(_) | Seen::Close(_) => camera::PORTRAIT_FOCAL,
        })
    }

    /// For people who find the picture later.
    pub(super) fn in_words(&self, asked: &RenderRequest) -> String {
        match &self.seen {
            Seen::Saved(SavedView { orthographic: Some(height), .. }) => {
                format!("{}, parallel, {height} cm high", self.name)
            }
            _ => format!("{}, {} mm", self.name, self.focal_mm(asked)),
        }
    }

    /// The camera there; `closest` is what [`Self::socket`] gave.
    pub(super) fn camera(
        &self,
        asked: &RenderRequest,
        subject: &Subject,
        closest: Option<&Value>,
    ) -> Result<Camera, Stop> {
        let focal_mm = self.focal_mm(asked);
        let view = match &self.seen {
            Seen::Head(view) => view.clone(),
            Seen::Saved(SavedView { eye, target, up, orthographic, .. }) => {
                let [eye, target, up] = [*eye, *target, *up].map(Vec3::from);
                return Ok(Camera { eye, target, up, focal_mm, orthographic: *orthographic });
            }
            Seen::Close(_) => {
                let points: Vec<Vec3> = match closest {
                    Some(Value::Curves(curves)) => {
                        curves.tufts().iter().flat_map(|tuft| tuft.points()).copied().collect()
                    }
                    _ => vec![],
                };
                if points.is_empty() {
                    let reason = format!("--camera {}: it gives no curves", self.name);
                    return Err(Stop::failed(reason));
                }
                Viewpoint::Close(points)
            }
        };
        let [width, height] = asked.size.map(|side| side as f32);
        Ok(camera::frame(&view, subject, focal_mm, width / height))
    }
}
