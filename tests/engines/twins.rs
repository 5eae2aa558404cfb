//! Theory: every WGSL file has a Rust twin of the same stem that names it, and every kernel an
//! entry point named like its stem.

use caustica::low_level::gpu::compose::compose;
use caustica::low_level::gpu::layout::SceneLayout;
use caustica::low_level::plan::Kernel;
use caustica::low_level::plan::features::Feature;
use std::collections::BTreeSet;
use std::fs;

use crate::support::{files, repository};

/// Shader files that implement one Rust module together, and a helper that Rust writes as a loop.
const PARTS: [(&str, &str); 9] = [
    ("kernels/grid_count", "kernels/grid_build"),
    ("kernels/grid_scan_reduce", "kernels/grid_build"),
    ("kernels/grid_scan_sums", "kernels/grid_build"),
    ("kernels/grid_scan", "kernels/grid_build"),
    ("kernels/grid_scatter", "kernels/grid_build"),
    ("kernels/grid_sort", "kernels/grid_build"),
    ("kernels/grid_sort_long", "kernels/grid_build"),
    ("kernels/sort", "kernels/grid_build"),
    ("kernels/scan", "kernels/grid_build"),
];

#[test]
fn shaders_have_rust_twins() {
    let mut missing = Vec::new();
    let shaders = repository("shaders");
    for shader in files(&shaders, "wgsl") {
        let stem = shader.strip_prefix(&shaders).unwrap().with_extension("");
        let stem = stem.to_str().unwrap().replace('\\', "/");
        let twin = PARTS
            .iter()
            .find(|(part, _)| *part == stem)
            .map_or(stem.as_str(), |(_, module)| module);
        let rust = repository("src").join(twin).with_extension("rs");
        if !rust.is_file() {
            missing.push(format!("{} has no {}", shader.display(), rust.display()));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn rust_twins_name_shaders_that_exist() {
    let mut missing = Vec::new();
    for rust in files(&repository("src"), "rs") {
        let text = fs::read_to_string(&rust).unwrap();
        let header: String = text.lines().take_while(|l| l.starts_with("//!")).collect();
        for name in header.split('`').filter(|w| w.starts_with("shaders/") && w.ends_with(".wgsl"))
        {
            if !repository(name).is_file() {
                missing.push(format!("{} names {name}", rust.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Each kernel's module has exactly one entry point, named like the file's stem and the Rust
/// function.
#[test]
fn entry_points_are_stems() {
    let rust: String = files(&repository("src/kernels"), "rs")
        .iter()
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    let functions: BTreeSet<&str> =
        rust.split("pub fn ").skip(1).filter_map(|rest| rest.split(['(', '<']).next()).collect();
    let mixture = crate::ingredients::Mixture::of(&[
        Feature::Sphere,
        Feature::Unbounded,
        Feature::Point,
        Feature::Sampled,
    ]);
    for kernel in Kernel::ALL {
        let stem = kernel.stem();
        assert!(repository(&format!("shaders/kernels/{stem}.wgsl")).is_file(), "{stem}");
        let shader =
            compose(kernel, &mixture.features(), &SceneLayout::new(&mixture.scene)).unwrap();
        let (module, _) = shader.validate().unwrap();
        let entries: Vec<_> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
        assert_eq!(entries, [stem]);
        let function = match kernel {
            Kernel::GridScanReduce | Kernel::GridScanSums => "grid_scan",
            Kernel::GridSortLong => "grid_sort",
            _ => stem,
        };
        assert!(functions.contains(function), "no Rust function `{function}`");
    }
}
