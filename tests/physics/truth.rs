//! Renders against reference images: the short form of `cargo run --release --example hold`.
//!
//! Theory: a box-filtered image of any size has the same expected means over the same squares, so
//! small films with 2 x 2 pixels to a block are compared with the block means of large images.
//! Differences are measured in standard errors of both (see `caustica::low_level::validation`).
//! Density estimation is biased, so it may differ by 1 % of a block; path tracing may not. Films,
//! seeds and passes are fixed, so on one device these tests are deterministic. Planted errors show
//! their power.

use crate::support::{folder, repository};
use caustica::low_level::device::Wanted;
use caustica::low_level::film::Picture;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::scene::{self, Scene};
use caustica::low_level::validation::agreement::LIMIT_FAR;
use caustica::low_level::validation::reference::{BLOCK, PixelNoise};
use caustica::low_level::validation::{
    Agreement, BlockTruth, Blocks, Rendered, hold, render_parts,
};

/// Edge of a block in pixels of the small films.
const EDGE: u32 = 2;
/// Allowance for the bias of density estimation.
const BIAS: f64 = 0.01;
/// Number of independent renders per image.
const RENDERS: u32 = 24;

fn load(name: &str) -> (Scene, BlockTruth) {
    let data = repository("tests/data");
    let mut scene = scene::load(&data.join(format!("reference/{name}.toml"))).unwrap().scene;
    let truth = BlockTruth::read(&data.join(format!("truth/{name}.exr"))).unwrap();
    (scene.film.width, scene.film.height) = (truth.mean.width * EDGE, truth.mean.height * EDGE);
    (scene, truth)
}

/// Half a pixel here is two pixels of the reference.
fn settings() -> RenderSettings {
    RenderSettings {
        passes: 4,
        photons: 16_384,
        radius: Radius::Pixels(0.5),
        ..RenderSettings::default()
    }
}

fn rendered(name: &str, settings: &RenderSettings) -> (Rendered, BlockTruth) {
    let (scene, truth) = load(name);
    let size = (truth.mean.width, truth.mean.height);
    (render_parts(&Wanted::Cpu, &scene, settings, RENDERS, size).unwrap(), truth)
}

#[track_caller]
fn assert_agrees(name: &str, settings: &RenderSettings, bias: f64) {
    let (rendered, truth) = rendered(name, settings);
    let a = hold(&rendered.parts, &truth, bias);
    println!(
        "{name} {:?} {:?} {:?}: mean {:.4?} +- {:.4?}, {} of {} blocks outside (<= {}), worst {:.1}; {} of {} regions, worst {:.1}",
        settings.method,
        settings.radius_rule,
        settings.direct,
        a.mean_ratio,
        a.ratio_error,
        a.blocks.outside(),
        a.blocks.values.len(),
        a.blocks.allowed,
        a.blocks.worst(),
        a.regions.outside(),
        a.regions.values.len(),
        a.regions.worst()
    );
    assert!(a.faults().is_empty(), "{name} {settings:?}: {:?}", a.faults());
    // Otherwise the mean would have little meaning.
    assert!(a.ratio_error.iter().all(|e| *e < 0.007), "{:?}", a.ratio_error);
}

#[test]
fn the_default_agrees_on_every_scene() {
    for name in ["cornell", "drop", "drop-clear", "mesh", "mesh-turned"] {
        assert_agrees(name, &settings(), BIAS);
    }
}

#[test]
fn every_rule_agrees_in_both_direct_modes() {
    for (name, radius_rule, direct) in [
        ("drop", RadiusRule::Global, Direct::Photons),
        ("cornell", RadiusRule::Local, Direct::Sampled),
        ("cornell", RadiusRule::Local, Direct::Photons),
        ("mesh", RadiusRule::Fixed, Direct::Sampled),
        ("cornell", RadiusRule::Fixed, Direct::Photons),
    ] {
        let small = Radius::Pixels(if radius_rule == RadiusRule::Fixed { 0.25 } else { 0.5 });
        // on wide ground few photons reach such a small disc, too few for a standard error
        let photons = if name == "mesh" { 1 << 16 } else { settings().photons };
        assert_agrees(
            name,
            &RenderSettings { radius_rule, direct, radius: small, photons, ..settings() },
            BIAS,
        );
    }
}

/// Photons scattered by a diffuse surface have a disc three times as wide, and a map guides half of
/// the photons.
#[test]
fn two_discs_agree_under_every_rule_and_in_both_direct_modes() {
    for (radius_rule, direct) in [
        (RadiusRule::Global, Direct::Sampled),
        (RadiusRule::Global, Direct::Photons),
        (RadiusRule::Local, Direct::Sampled),
    ] {
        let discs = RenderSettings {
            indirect_radius: Some(3.0),
            radius: Radius::Pixels(0.25),
            ..settings()
        };
        assert_agrees("cornell", &RenderSettings { radius_rule, direct, ..discs }, BIAS);
    }
}

#[test]
fn ppm_agrees_under_every_rule_and_in_both_direct_modes() {
    for (name, radius_rule, direct) in [
        ("cornell", RadiusRule::Global, Direct::Photons),
        ("mesh", RadiusRule::Global, Direct::Sampled),
        ("drop", RadiusRule::Local, Direct::Sampled),
        ("cornell", RadiusRule::Local, Direct::Photons),
        ("cornell", RadiusRule::Fixed, Direct::Sampled),
        ("drop", RadiusRule::Fixed, Direct::Photons),
    ] {
        let small = Radius::Pixels(0.25);
        let ppm = RenderSettings { method: Method::Ppm, radius: small, ..settings() };
        // of a thousand eye paths at the drop's tip one or two see the lamp and bring two thirds of
        // the light there
        let eye_samples = if name == "drop" { 64 } else { ppm.eye_samples };
        assert_agrees(name, &RenderSettings { radius_rule, direct, eye_samples, ..ppm }, BIAS);
    }
}

#[test]
fn path_tracing_agrees_without_any_allowance() {
    let path = RenderSettings { method: Method::Path, passes: 16, ..settings() };
    assert_agrees("mesh", &path, 0.0);
}

/// Errors planted into a render that agrees are detected: 1.5 % of brightness, 1.5 % in one
/// channel, one wrong block, a band that is 8 % too dark, an image upside down, and a part that is
/// not finite.
#[test]
fn planted_errors_are_found() {
    let (rendered, truth) = rendered("cornell", &settings());
    let faults = |wrong: &dyn Fn(usize, [f64; 3]) -> [f64; 3]| {
        let change = |part: &Blocks| Blocks {
            rgb: part.rgb.iter().enumerate().map(|(i, rgb)| wrong(i, *rgb)).collect(),
            ..*part
        };
        hold(&rendered.parts.iter().map(change).collect::<Vec<_>>(), &truth, BIAS).faults()
    };
    assert!(faults(&|_, rgb| rgb).is_empty());
    assert!(faults(&|_, rgb| rgb.map(|v| v * 1.015)).contains(&"mean"));
    assert!(faults(&|_, [r, g, b]| [r, g * 1.015, b]).contains(&"mean"));
    let lit = 24 * 64 + 32;
    assert_eq!(faults(&|i, rgb| if i == lit { rgb.map(|v| v * 1.5) } else { rgb }), ["one block"]);
    assert!(
        faults(&|i, rgb| if i / 256 == 6 { rgb.map(|v| v * 0.92) } else { rgb })
            .contains(&"regions")
    );
    assert_eq!(faults(&|i, rgb| if i == lit { [f64::NAN; 3] } else { rgb }), ["mean", "one block"]);
    let upside_down =
        |part: &Blocks| Blocks::from_fn(64, 64, |x, y| part.rgb[((63 - y) * 64 + x) as usize]);
    let turned: Vec<_> = rendered.parts.iter().map(upside_down).collect();
    assert!(hold(&turned, &truth, BIAS).faults().contains(&"blocks"));
}

/// Random numbers of mean zero and variance one, nearly normal: the sum of twelve uniform ones (an
/// LCG of Knuth's).
fn noise() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        (0..12).fold(-6.0, |sum, _| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum + (state >> 11) as f64 / (1_u64 << 53) as f64
        })
    }
}

/// Without a renderer: parts made of a reference plus noise of known size agree with it, their
/// deviations are as wide as Student's t predicts or a little narrower (pooled variances), and the
/// error of their mean is the planted one.
#[test]
fn noise_of_known_size_agrees() {
    let mut next = noise();
    let (width, height, parts) = (40, 30, 24);
    let mean = Blocks::from_fn(width, height, |x, y| {
        [1.0 + 0.1 * f64::from(x), 2.0, 0.5 + 0.1 * f64::from(y)]
    });
    let standard_error = Blocks::from_fn(width, height, |_, _| [0.01; 3]);
    let seen = Blocks::from_fn(width, height, |x, y| {
        mean.rgb[(y * width + x) as usize].map(|v| v + 0.01 * next())
    });
    let truth = BlockTruth { mean: seen, standard_error };
    let part = |_| Blocks {
        rgb: mean.rgb.iter().map(|rgb| rgb.map(|v| v + 0.1 * next())).collect(),
        ..mean
    };
    let parts: Vec<_> = (0..parts).map(part).collect();
    let a: Agreement = hold(&parts, &truth, 0.0);
    assert!(a.faults().is_empty() && a.blocks.worst().abs() < LIMIT_FAR, "{a:?}");
    // The largest of three channels: E max(|z|) is 1.33 for normal ones.
    let size = a.blocks.values.iter().map(|d| d.abs()).sum::<f64>() / 1200.0;
    assert!((1.1..1.4).contains(&size), "{size}");
    let error = 0.1 / (24.0_f64 * 1200.0).sqrt();
    assert!((a.ratio_error[1] * 2.0 / error - 1.0).abs() < 0.5, "{:?}", a.ratio_error);
}

/// Block means and errors computed by hand: 16 x 8 pixels are two blocks. 64 pixels of error e have
/// a mean of error e / 8, and the mean of two blocks has sqrt(2) / 2 of one block's error.
#[test]
fn blocks_of_a_picture() {
    let picture =
        Picture::from_fn(16, 8, |x, _| if x < 8 { [1.0; 3] } else { [3.0 + (x % 2) as f32; 3] });
    let errors = Picture::from_fn(16, 8, |_, _| [0.4; 3]);
    let truth = BlockTruth::from_picture(&picture, &PixelNoise::Known(errors)).unwrap();
    assert_eq!(truth.mean.rgb, [[1.0; 3], [3.5; 3]]);
    assert!(truth.standard_error.rgb.iter().all(|e| (e[0] - 0.05).abs() < 1e-7));
    assert!((truth.mean_error()[2] - 0.05 / 2.0_f64.sqrt()).abs() < 1e-7);
    // Variance 0.01 (1 + 0.01) of each pixel.
    let truth = BlockTruth::from_picture(&picture, &PixelNoise::RelMse(0.01)).unwrap();
    assert!((truth.standard_error.rgb[0][0] - 0.0101_f64.sqrt() / f64::from(BLOCK)).abs() < 1e-7);
    // Smaller images nest; others do not.
    let small = Picture::from_fn(4, 2, |x, _| [if x < 2 { 1.0 } else { 3.5 }; 3]);
    assert_eq!(Blocks::of(&small, 2, 1).unwrap(), truth.mean);
    assert_eq!(Blocks::of(&small, 3, 1), None);
    let file = folder("blocks").join("truth.exr");
    truth.write(&file).unwrap();
    let read = BlockTruth::read(&file).unwrap();
    assert_eq!(read.mean, truth.mean);
    assert!((read.standard_error.rgb[1][1] / truth.standard_error.rgb[1][1] - 1.0).abs() < 1e-6);
}
