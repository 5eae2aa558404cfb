//! WGSL generated from the kinds of materials and lights: their numbers, tests of a kind, and the
//! dispatch over the materials in the scene.

use crate::lights::LightKind;
use crate::materials::Bsdf;
use crate::plan::Kernel;
use crate::plan::features::{Feature, Features};

/// Declarations that `kernel` needs.
pub fn dispatch(kernel: Kernel, features: Features) -> String {
    let gathers = kernel == Kernel::Gather && features.has(Feature::Lobes);
    let traces = kernel.info().traces;
    if !traces && !gathers {
        return String::new();
    }
    let held = |bsdf: &&Bsdf| features.has(Feature::Material(**bsdf));
    let (layered, scattering): (Vec<Bsdf>, Vec<Bsdf>) =
        Bsdf::ALL.iter().filter(held).partition(|bsdf| bsdf.is_layered());
    let (specular, rough): (Vec<Bsdf>, Vec<Bsdf>) =
        scattering.iter().partition(|bsdf| bsdf.is_specular());
    let mut out: String = Bsdf::ALL
        .iter()
        .map(|bsdf| {
            format!("const MATERIAL_{}: u32 = {}u;\n", bsdf.name().to_uppercase(), *bsdf as u32)
        })
        .collect();
    let is = |name: &str, kinds: &mut dyn Iterator<Item = &Bsdf>| {
        test_of(name, &mut kinds.map(|bsdf| *bsdf as u32))
    };
    // functions of `shading.wgsl` add what a coat takes
    let coated = features.has(Feature::Coated);
    let name = |function: &str| function.to_owned() + if coated { "_uncoated" } else { "" };
    out += &is("transmits", &mut rough.iter().filter(|bsdf| bsdf.transmits()));
    out += &cases(
        &format!("{}(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f", name("eval_rough")),
        ("lobe.bsdf", "eval", "(lobe, n, wo, wi)", "vec3f(0.0)"),
        &rough,
    );
    if !traces {
        return out;
    }
    out += &lights();
    out += &is("is_specular", &mut specular.iter());
    out += &is("is_parametric", &mut rough.iter().filter(|bsdf| bsdf.is_parametric()));
    out += &is("is_body", &mut scattering.iter().filter(|bsdf| bsdf.is_body()));
    out += &is("is_reflector", &mut rough.iter().filter(|bsdf| bsdf.is_reflector()));
    out += &is("is_wide", &mut rough.iter().filter(|bsdf| bsdf.is_wide()));
    out += &cases(
        "pdf_rough(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32",
        ("lobe.bsdf", "pdf", "(lobe, n, wo, wi)", "0.0"),
        &rough,
    );
    out += &cases(
        &format!("{}(p: ShadingPoint, u: vec3f, mode: u32) -> Sample", name("sample_rough")),
        ("p.lobe.bsdf", "sample", "(p, u, mode)", "Sample(p.wo, vec3f(0.0))"),
        &rough,
    );
    out += &cases(
        &format!(
            "{}(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter",
            name("scatter_specular")
        ),
        ("p.lobe.bsdf", "scatter", "(p, interior, u, mode)", "Scatter(p.wo, interior, vec3f(0.0))"),
        &specular,
    );
    if !layered.is_empty() {
        out += &is("is_layered", &mut layered.iter());
        out += &cases(
            "choose_once(p: ShadingPoint, u: f32) -> Layer",
            ("p.lobe.bsdf", "choose", "(p, u)", "Layer(p.lobe, 1.0, u)"),
            &layered,
        );
    }
    out
}

/// Numbers of the lights' kinds, and the tests of a kind.
fn lights() -> String {
    let kinds = || LightKind::ALL.into_iter();
    let mut out: String = kinds()
        .map(|kind| format!("const LIGHT_{}: u32 = {}u;\n", kind.name(), kind as u32))
        .collect();
    let mut put = |name, holds: fn(LightKind) -> bool| {
        out += &test_of(name, &mut kinds().filter(|kind| holds(*kind)).map(|kind| kind as u32));
    };
    put("is_infinite", LightKind::is_infinite);
    put("is_environment", LightKind::is_environment);
    put("is_extended", LightKind::is_extended);
    out
}

/// Generates a function that tests whether a kind is one of `kinds`.
fn test_of(name: &str, kinds: &mut dyn Iterator<Item = u32>) -> String {
    let tests: Vec<String> = kinds.map(|kind| format!("kind == {kind}u")).collect();
    let condition = if tests.is_empty() { "false".to_owned() } else { tests.join(" || ") };
    format!("fn {name}(kind: u32) -> bool {{\n    return {condition};\n}}\n")
}

/// Generates a function that calls `PREFIX_MATERIAL` by the kind, or returns `other`. A single
/// material needs no test.
fn cases(
    signature: &str,
    (kind, prefix, arguments, other): (&str, &str, &str, &str),
    materials: &[Bsdf],
) -> String {
    let call = |bsdf: &Bsdf| format!("{prefix}_{}{arguments}", bsdf.name());
    let body = match materials {
        [] => format!("    return {other};\n"),
        [only] => format!("    return {};\n", call(only)),
        several => {
            let case = |bsdf: &Bsdf| {
                format!("        case {}u: {{ return {}; }}\n", *bsdf as u32, call(bsdf))
            };
            let cases: String = several.iter().map(case).collect();
            format!("    switch {kind} {{\n{cases}        default: {{ return {other}; }}\n    }}\n")
        }
    };
    format!("fn {signature} {{\n{body}}}\n")
}
