//! Shaders, the Rust twins of their structs and the passes. Empty until the renderer lands.
