//! Everything of coif that talks to the GPU: WGSL, the Rust twins of its structs, and the passes.
//!
//! Strands, surfaces, lights and a camera go in; a scene-linear picture comes out, refined sample by
//! sample. No window is needed: the command line and the viewport use the same [`Renderer`].
//!
//! Guaranteed: the same scene gives the same bytes on one adapter, whatever its number of threads.
//! Not guaranteed: the same bytes on two different adapters.

pub mod camera;
pub mod chart;
pub mod display;
pub mod environment;
mod frame;
mod gpu;
mod hair;
pub mod hdri;
pub mod legend;
pub mod light;
pub mod maps;
pub mod picture;
mod pipelines;
pub mod renderer;
pub mod small;
mod solids;
mod source;
mod strands;
pub mod surface;
mod twins;
pub mod view;

pub use camera::{Camera, Sphere, Subject, Viewpoint};
pub use display::Transform;
pub use environment::{Backdrop, Environment};
pub use gpu::{Gpu, GpuError, Precision};
pub use hair::{Model, UnknownModel};
pub use hdri::{Hdri, HdriError};
pub use light::{Light, Rig};
pub use picture::{Picture, PictureError, Samples};
pub use renderer::{Effort, Look, Pass, Progress, RenderError, Renderer};
pub use strands::Uploaded;
pub use surface::{Material, RootGrid, Solid};
pub use view::{GroomColours, Legend, Paint, Ramp, Shading, View};
