//! The principled material, textures for roughness, and rough panes: closed forms, and agreement
//! with the materials that they consist of.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::agreement::pairwise;
use super::lab::*;
use super::maps::{map, texture};
use super::materials::{CAMERA, agrees, floor};

const METHODS: [(Method, Direct); 2] =
    [(Method::Path, Direct::Sampled), (Method::Sppm, Direct::Photons)];

/// Checks that floors of two materials have the same mean.
fn same(what: &str, a: &str, b: &str, textures: &str, methods: &[(Method, Direct)]) {
    for &(method, direct) in methods {
        let mean = |material: &str, seed: u64| {
            let at = DVec3::new(0.3, 0.8, -0.5);
            let text = floor(material, at.into()) + textures;
            let settings =
                RenderSettings { method, direct, seed, eye_samples: 16, ..settings(0.03) };
            runs_to(0.05, &text, &settings).region(|_, _| true)
        };
        assert_same(&format!("{what}, {method:?} {direct:?}"), mean(a, 1), mean(b, 1000), 0.06);
    }
}

/// Theory: where a texture has one value only, the material is that with the value as a number.
/// Between two values of a series the image is linear in the value.
#[test]
fn roughness_by_texture() {
    // half and half 102 and 204, that is .4 and .8
    let halves = map("halves", (8, 1), |x, _| [if x % 2 == 0 { 102 } else { 204 }; 3]);
    let even = map("even-roughness", (2, 2), |_, _| [153; 3]);
    let textures = texture("half", &halves, "filter = \"nearest\"\nscale = [64.0, 1.0]")
        + &texture("even", &even, "");
    let photons = "type = \"metal\"\nmaterial = \"copper\"";
    for kind in [
        "type = \"metal\"\nreflectance = [0.9, 0.6, 0.3]",
        photons,
        "type = \"plastic\"\nreflectance = [0.5, 0.3, 0.6]",
        "type = \"diffuse\"\nreflectance = 0.8",
        "type = \"principled\"\nbase_color = [0.5, 0.3, 0.6]\nmetallic = 0.5",
    ] {
        let with = |roughness: &str| format!("{kind}\nroughness = {roughness}");
        same(&format!("even, {kind}"), &with("\"even\""), &with("0.6"), &textures, &METHODS[..1]);
        // the floor's stripes of both kinds lie next to one another
        let mix = "type = \"mix\"\nmaterials = [\"low\", \"high\"]\namount = 0.5";
        let parts =
            format!("[materials.low]\n{}\n[materials.high]\n{}\n", with("0.4"), with("0.8"));
        let textures = textures.clone() + &parts;
        let methods = &METHODS[..if kind == photons { 2 } else { 1 }];
        same(&format!("stripes, {kind}"), &with("\"half\""), mix, &textures, methods);
    }
}

/// Theory: a principled material with amounts of 0 and 1 is one of the simple materials.
#[test]
fn principled_is_made_of_simple_materials() {
    let color = "[0.7, 0.5, 0.2]";
    let principled = |keys: &str| format!("type = \"principled\"\nbase_color = {color}\n{keys}");
    for (keys, simple) in [
        ("metallic = 1\nroughness = 0.6", "type = \"metal\"\nreflectance = C\nroughness = 0.6"),
        (
            "metallic = 0\nroughness = 0.5\nior = 1.4",
            "type = \"plastic\"\nreflectance = C\nroughness = 0.5\nior = 1.4",
        ),
        ("specular = 0", "type = \"diffuse\"\nreflectance = C"),
        (
            "clearcoat = 1\nclearcoat_roughness = 0.4\nspecular = 0",
            "type = \"plastic\"\nreflectance = C\nroughness = 0.4\nior = 1.5",
        ),
    ] {
        same(keys, &principled(keys), &simple.replace('C', color), "", &METHODS[..1]);
    }
}

/// Theory: metal below a smooth clear coat has the radiance `(1 - F(o)) (1 - F(i)) f I cos / d^2`,
/// away from the mirrored direction, with Schlick's and the dielectric Fresnel terms of both.
#[test]
fn coated_metal() {
    let (alpha, f0) = (0.8f64 * 0.8, 0.8);
    let coated = "type = \"principled\"\nbase_color = 0.8\nmetallic = 1\nroughness = 0.8\n\
                  clearcoat = 1";
    let at = DVec3::new(-0.6, 1.0, -0.8);
    let albedo = caustica::low_level::pack::albedo::Albedo::of(alpha, |_| 1.0);
    let once = |cos: f64| {
        albedo.terms.iter().enumerate().map(|(i, t)| t * cos.powi(i as i32)).sum::<f64>()
    };
    let mean_fresnel = f0 * 20.0 / 21.0 + 1.0 / 21.0;
    let lambda =
        |cos: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 - cos * cos) / (cos * cos)).sqrt() - 1.0);
    let passed = |cos: f64| {
        let inside = (1.0 - (1.0 - cos * cos) / 2.25f64).sqrt();
        let s = (cos - 1.5 * inside) / (cos + 1.5 * inside);
        let p = (1.5 * cos - inside) / (1.5 * cos + inside);
        1.0 - 0.5 * (s * s + p * p)
    };
    let radiance = |p: DVec3| {
        let (wi, wo) = ((at - p).normalize(), (CAMERA.position - p).normalize());
        let h = (wi + wo).normalize();
        let d = {
            let a = alpha * alpha;
            let x = h.y * h.y * (a - 1.0) + 1.0;
            a / (PI * x * x)
        };
        let f = f0 + (1.0 - f0) * (1.0 - wo.dot(h)).powi(5);
        let g = 1.0 / (1.0 + lambda(wi.y) + lambda(wo.y));
        let lost = (1.0 - once(wi.y)) * (1.0 - once(wo.y)) / (PI * (1.0 - albedo.mean()));
        let again = mean_fresnel * mean_fresnel * albedo.mean()
            / (1.0 - mean_fresnel * (1.0 - albedo.mean()))
            * lost;
        let metal = f * d * g / (4.0 * wi.y * wo.y) + again;
        passed(wi.y) * passed(wo.y) * metal * wi.y / at.distance_squared(p)
    };
    agrees("coated metal", &floor(coated, at.into()), radiance);
}

/// Theory: all methods estimate one integral, with textures for every parameter.
#[test]
fn methods_agree_on_principled_materials() {
    let spots = map("spots", (4, 4), |x, y| [(x * 60 + y * 15) as u8 + 20; 3]);
    let textures = texture("t", &spots, "scale = [3.0, 3.0]");
    let camera = Camera {
        position: DVec3::new(0.0, 1.2, 3.4),
        target: DVec3::new(0.0, 0.6, 0.0),
        fov: 40.0,
        size: 24,
    };
    let text = camera.toml()
        + &textures
        + "[materials.floor]\ntype = \"principled\"\nbase_color = \"t\"\nroughness = \"t\"\n\
           metallic = \"t\"\nspecular = \"t\"\nclearcoat = \"t\"\nclearcoat_roughness = 0.5\n\
           [materials.sheet]\ntype = \"principled\"\nbase_color = [0.9, 0.7, 0.6]\n\
           roughness = 0.6\ntransmission = 0.7\n\
           [materials.pane]\ntype = \"glass\"\nior = 1.5\nthin = true\nroughness = 0.7\n\
           transmittance = [0.9, 0.8, 0.7]\n\
           [materials.black]\ntype = \"diffuse\"\nreflectance = 0\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\nv = [0, 0, -4]\n\
           material = \"floor\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, -1]\nu = [4, 0, 0]\nv = [0, 3, 0]\n\
           material = \"floor\"\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [-0.6, 0.5, 0]\nradius = 0.5\n\
           material = \"sheet\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [0.3, 0.1, 0.3]\nu = [0.9, 0, -0.2]\n\
           v = [0, 1, 0]\nmaterial = \"pane\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-0.6, 2.4, -0.6]\nu = [1.2, 0, 0]\n\
           v = [0, 0, 1.2]\nmaterial = \"black\"\nemission = 5\n";
    let cases = [
        (Method::Path, Direct::Sampled, RadiusRule::Fixed),
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Ppm, Direct::Photons, RadiusRule::Fixed),
    ];
    pairwise("principled", &text, &cases, 0.06);
}

/// Theory: a white rough pane in even light is invisible: what it does not reflect, it lets pass.
#[test]
fn white_panes_are_invisible() {
    for roughness in [0.3, 0.7, 1.0] {
        let text = CAMERA.toml()
            + &format!(
                "[environment]\nradiance = 1.0\n[materials.m]\ntype = \"glass\"\nior = 1.5\n\
                 thin = true\nroughness = {roughness:?}\n[[shapes]]\ntype = \"disc\"\n\
                 center = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3.0\nmaterial = \"m\"\n"
            );
        for (method, direct) in [(Method::Sppm, Direct::Sampled), (Method::Path, Direct::Photons)] {
            let settings =
                RenderSettings { method, direct, passes: 4, photons: 1 << 14, ..settings(0.05) };
            let found = runs_to(0.02, &text, &settings).region(|_, _| true);
            assert_agrees(&format!("roughness {roughness}, {method:?}"), found, 1.0, 0.02);
        }
    }
}
