//! Fuzz targets and the programs that libFuzzer runs.

mod targets;

pub use cap::Cap;
pub use targets::{Case, MEMORY, TARGETS, Target, export, gltf, obj, render, scan, scene};

/// Makes a program of a target, with the limit of memory.
#[macro_export]
macro_rules! fuzz {
    ($target:ident) => {
        #[global_allocator]
        static ALLOCATOR: $crate::Cap<std::alloc::System> =
            $crate::Cap::new(std::alloc::System, $crate::MEMORY);

        libfuzzer_sys::fuzz_target!(|bytes: &[u8]| $crate::$target(bytes));
    };
}
