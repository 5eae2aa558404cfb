//! Energy conservation: emitted photons are absorbed, escape, or are cut off by `max_bounces`.

use std::f64::consts::PI;

use caustica::low_level::device;
use caustica::low_level::engine::PhotonEnds;
use caustica::low_level::kernels::photon_trace::photon_trace;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::settings::{Direct, RenderSettings};
use glam::DVec3;

use super::lab::*;

const ALBEDO: f64 = 0.6;
const CUT_AT: u32 = 3;

/// A point source over the middle of a disc of radius 1 at height `h`, or inside a closed ball.
fn scene(closed: bool, h: f64) -> String {
    let shape = if closed {
        "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1.5"
    } else {
        "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 1"
    };
    Camera { position: DVec3::new(0.0, 0.9, 0.9), target: DVec3::ZERO, fov: 20.0, size: 4 }.toml()
        + &format!(
            "[materials.grey]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n[[shapes]]\n{shape}\n\
             material = \"grey\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {h}, 0]\nintensity = 2\n"
        )
}

fn settings(closed: bool) -> RenderSettings {
    let max_bounces = if closed { CUT_AT } else { 64 };
    RenderSettings {
        photons: 100_003,
        max_bounces,
        direct: Direct::Photons,
        ..super::lab::settings(0.05)
    }
}

/// Counts how the photons of one pass end on a device.
fn ends(device: &str, text: &str, settings: &RenderSettings) -> PhotonEnds {
    let mut engine = device::open(&device::parse(device), &parse(text), settings).unwrap().engine;
    engine.pass().unwrap().ends
}

/// Whether `count` of `n` is likely at a probability of `p` (5 standard deviations).
fn likely(count: u64, n: u32, p: f64) -> bool {
    let n = f64::from(n);
    (count as f64 - n * p).abs() <= 5.0 * (n * p * (1.0 - p)).sqrt()
}

/// Theory: every photon ends in one of three ways, so the counts add up exactly, and to the same
/// numbers on every device. Over a disc seen from h under the half angle a, (1 + cos a) / 2 of the
/// photons miss it, and rho of the others leave it again: both escape. In a closed room nothing
/// escapes, and rho^(b + 1) is cut after b bounces (the walls are met b + 1 times).
#[test]
fn photons_are_counted() {
    let h = 0.7f64;
    let missed = 0.5 * (1.0 + h / (h * h + 1.0).sqrt());
    for (closed, escaped, cut) in [
        (false, missed + (1.0 - missed) * ALBEDO, 0.0),
        (true, 0.0, ALBEDO.powi(CUT_AT as i32 + 1)),
    ] {
        let (text, settings) = (scene(closed, h), settings(closed));
        let found = ends("cpu", &text, &settings);
        println!("closed {closed}: {found:?}");
        assert_eq!(found.total(), u64::from(settings.photons));
        assert!(likely(found.escaped, settings.photons, escaped), "{found:?}, {escaped} escape");
        assert!(likely(found.cut, settings.photons, cut), "{found:?}, {cut} are cut");
        assert!(
            !likely(found.escaped, settings.photons, escaped + 0.01)
                && !likely(found.cut, settings.photons, cut + 0.01)
        );
        assert_eq!(found, ends("software", &text, &settings));
    }
}

/// Theory: at each hit of flux f the surface absorbs (1 - rho) f and scatters rho f, in the mean
/// over roulette. So the stored flux times (1 - rho), plus the escaped and cut flux, is the emitted
/// flux. In a closed room that is Phi (1 - rho) sum rho^k = Phi (1 - rho^(b + 1)) for the walls.
/// Roulette keeps the flux of a survivor on grey walls, so the balance is one of counts: stored =
/// hits.
#[test]
fn stored_flux_is_emitted_flux() {
    let (text, settings) = (scene(true, 0.7), settings(true));
    let scene = parse(&text);
    let packed = prepare(&scene, 4, 4).unwrap();
    let dispatch = Plan::probed(&packed, &settings).dispatch(0);
    let phi = 4.0 * PI * 2.0;
    let unit = packed.unit * packed.unit * packed.radiance_unit;
    let parts: Vec<f64> = (0..20u32)
        .map(|part| {
            let mut sum = 0.0;
            for id in part * 2000..(part + 1) * 2000 {
                let _ = photon_trace(&packed.tables, &dispatch, false, id, |r| {
                    sum += f64::from(r.flux.x)
                });
            }
            sum * unit / 2000.0
        })
        .collect();
    let stored = phi * (1.0 - ALBEDO.powi(CUT_AT as i32 + 1)) / (1.0 - ALBEDO);
    assert_agrees("stored flux", Estimate::of(&parts), stored, 0.02);
}
