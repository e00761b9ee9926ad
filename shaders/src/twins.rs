//! Rust twins of WGSL structs: declared once here, compared with naga's reflection by a test.
//!
//! **Invariant:** every struct that both sides share is declared by [`twins!`], so that a member that
//! moves on one side fails a test and never a picture.

/// Declares `#[repr(C)]` structs that have a twin of the same name in a WGSL file.
macro_rules! twins {
    ($file:literal: $(
        $(#[doc = $doc:literal])*
        struct $name:ident { $($(#[doc = $field_doc:literal])* $field:ident: $ty:ty,)* }
    )*) => {
        $(
            $(#[doc = $doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
            pub(crate) struct $name { $($(#[doc = $field_doc])* pub(crate) $field: $ty,)* }
        )*
        #[cfg(test)]
        #[test]
        fn structs_have_the_layout_that_their_shaders_read() {
            let module = crate::source::tests::module($file);
            $(
                crate::twins::tests::check(
                    &module,
                    stringify!($name),
                    size_of::<$name>(),
                    &[$((stringify!($field), std::mem::offset_of!($name, $field))),*],
                );
            )*
        }
    };
}
pub(crate) use twins;

#[cfg(test)]
pub(crate) mod tests {
    use wgpu::naga;

    /// Compares a struct's members, offsets and size with those of the WGSL struct of its name.
    #[track_caller]
    pub(crate) fn check(module: &naga::Module, name: &str, size: usize, ours: &[(&str, usize)]) {
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
        let Some((_, ty)) = found else { panic!("the shader has no struct {name}") };
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct")
        };
        let theirs: Vec<(&str, usize)> =
            members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
        assert_eq!(theirs, ours, "{name}");
        assert_eq!(*span as usize, size, "size of {name}");
    }
}
