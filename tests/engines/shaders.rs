//! Every composition of the shaders parses and validates: each feature alone, all of them, and a
//! range of mixtures.
//!
//! Theory: wgpu compiles with naga, so a module that naga accepts here compiles in a render.

use crate::ingredients::Mixture;
use caustica::low_level::gpu::compose::{compose, compose_from};
use caustica::low_level::gpu::fragments::{Fragment, fragments};
use caustica::low_level::gpu::layout::{Bound, SceneLayout, bindings};
use caustica::low_level::plan::Kernel;
use caustica::low_level::plan::features::{Feature, Features};
use std::collections::BTreeSet;

/// Each feature alone, all of them, and `count` mixtures from a fixed sequence of random bits.
fn mixtures(count: usize) -> Vec<Vec<Feature>> {
    let mut all: Vec<Vec<_>> = Feature::all().map(|feature| vec![feature]).collect();
    all.push(Vec::new());
    all.push(Feature::all().collect());
    let mut state = 1u64;
    for _ in 0..count {
        all.push(
            Feature::all()
                .filter(|_| {
                    state =
                        state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    state >> 62 == 0
                })
                .collect(),
        );
    }
    all
}

/// Validates all compositions of `fragments`. Lists each error once, with the first mixture that
/// shows it.
fn faults(fragments: &[Fragment], count: usize) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let mut list = Vec::new();
    for names in mixtures(count) {
        let mixture = Mixture::of(&names);
        let tables = SceneLayout::new(&mixture.scene);
        for kernel in mixture.kernels() {
            let shader = compose_from(fragments, kernel, &mixture.features(), &tables);
            let fault = shader.and_then(|s| s.validate().map(|_| ())).err();
            list.extend(
                fault
                    .filter(|e| seen.insert(e.to_string()))
                    .map(|e| format!("{e} ({} with {names:?})", kernel.stem())),
            );
        }
    }
    list
}

#[test]
fn every_composition_is_valid() {
    let list = faults(&fragments(), 150);
    assert!(list.is_empty(), "{} faults:\n{}", list.len(), list.join("\n"));
}

/// The layer of direct light adds code to its kernel only.
#[test]
fn the_layer_of_direct_light_is_valid() {
    for names in mixtures(20) {
        let mixture = Mixture::of(&names);
        let (features, tables) = (mixture.features(), SceneLayout::new(&mixture.scene));
        let source = |features: &Features| {
            let shader = compose(Kernel::AovTrace, features, &tables).unwrap();
            shader.validate().unwrap_or_else(|e| panic!("{e} with {names:?}"));
            shader.source
        };
        let (without, with) = (source(&features), source(&features.with(Feature::DirectLayer)));
        assert_eq!(without != with, features.has(Feature::Sampled), "{names:?}");
    }
}

/// The mixtures contain every feature.
#[test]
fn every_feature_is_mixed() {
    // the layer of direct light depends on the film
    for feature in Feature::all().filter(|feature| *feature != Feature::DirectLayer) {
        assert!(Mixture::of(&[feature]).features().has(feature), "{feature:?}");
    }
}

/// A kernel's module contains everything that the scene requires and nothing else.
#[test]
fn only_what_is_required() {
    let source = |features: &[Feature]| {
        let mixture = Mixture::of(features);
        compose(Kernel::EyeTrace, &mixture.features(), &SceneLayout::new(&mixture.scene))
            .unwrap()
            .source
    };
    let plain = source(&[Feature::Sphere, Feature::Unbounded]);
    for word in [
        "traverse",
        "Revolution",
        "sample_light",
        "fn fresnel",
        "ggx",
        "eval_texture",
        "triangles[",
        "camera.aperture",
    ] {
        assert!(!plain.contains(word), "{word}");
    }
    let rich = source(&Feature::all().collect::<Vec<_>>());
    for word in [
        "traverse",
        "Revolution",
        "sample_light",
        "fn fresnel",
        "ggx",
        "eval_texture",
        "triangles[",
        "camera.aperture",
    ] {
        assert!(rich.contains(word), "{word}");
    }
}

/// Theory: WebGPU guarantees only eight storage buffers.
#[test]
fn at_most_eight_storage_buffers() {
    let features = Mixture::of(&Feature::all().collect::<Vec<_>>()).features();
    for kernel in Kernel::ALL {
        let storage = bindings(kernel, features).iter().filter(|b| **b != Bound::Dispatch).count();
        assert!(storage <= 8, "{}: {storage}", kernel.stem());
    }
}

/// The check finds a typo planted in any file, and reports file and line.
#[test]
fn a_planted_error_is_found() {
    for (path, right, wrong) in [
        ("shapes/sphere.wgsl", "let root = sqrt(discriminant);", "let root = sqrtt(discriminant);"),
        ("kernels/gather.wgsl", "count += 1u;", "count += 1.0;"),
        ("kernels/grid_sort.wgsl", "let key = records[item].key;", "let key = records[item].kez;"),
        (
            "lights/select.wgsl",
            "fn choose_light(shares: u32, u: f32)",
            "fn choose_light(shares: u32, u: f33)",
        ),
        ("kernels/resolve.wgsl", "var state = 0u;", "var state = 0u"),
        ("materials/shading.wgsl", "//#if textures", "//#if texturs"),
        ("materials/glass.wgsl", "let eta = relative_ior(", "let eta = relative_ier("),
    ] {
        let mut fragments = fragments();
        let fragment = fragments.iter_mut().find(|f| f.path == path).unwrap();
        let (before, _) =
            fragment.text.split_once(right).unwrap_or_else(|| panic!("{path} has no `{right}`"));
        let line = before.matches('\n').count() + 1;
        fragment.text = Box::leak(fragment.text.replacen(right, wrong, 1).into_boxed_str());
        let list = faults(&fragments, 0);
        let at = [format!("{path}:{line}:"), format!("{path}:{}:", line + 1)];
        assert!(
            list.iter().any(|f| at.iter().any(|at| f.starts_with(at))),
            "{path}:{line} not in {list:#?}"
        );
        assert!(list.iter().all(|f| f.starts_with(path)), "{list:#?}");
    }
}
