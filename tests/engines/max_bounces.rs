//! Renders without bounces: only light seen directly, and light straight from lights.
//!
//! Theory: a diffuse floor of reflectance rho under a point light of intensity I at height h has
//! radiance rho I / (pi h^2) right below it. A white wall behind it reflects light, which counts
//! from one bounce on. Sampled from a point, direct light has no variance; by photons it is the
//! mean over the gather disc of a known flux.

use std::f64::consts::PI;
use std::path::Path;

use caustica::low_level::device::Wanted;
use caustica::low_level::film::Picture;
use caustica::low_level::scene;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};

use crate::support::{render_on, sound};

/// The scene. The camera sees a patch of 1/100 around the point below the light, with the material
/// `looks_at`.
fn scene_text(looks_at: &str) -> String {
    format!(
        "version = 1\n[camera]\nposition = [0, 1, 2]\ntarget = [0, 0, 0]\nfov = 0.25\n[film]\n\
         width = 4\nheight = 4\n\
         [render]\nmax_bounces = 0\npasses = 4\nphotons = 200_000\nradius = {{ units = 0.05 }}\n\
         [materials.grey]\ntype = \"diffuse\"\nreflectance = 0.6\n[materials.chrome]\n\
         type = \"mirror\"\nreflectance = 1\n\
         [materials.white]\ntype = \"diffuse\"\nreflectance = 1\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\nv = [0, 0, -4]\n\
         material = \"{looks_at}\"\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, -0.5]\nu = [4, 0, 0]\nv = [0, 3, 0]\n\
         material = \"white\"\n\
         [[lights]]\ntype = \"point\"\nposition = [0, 1.5, 0]\nintensity = [3, 2, 1]\n"
    )
}

fn render(looks_at: &str, wanted: &Wanted, change: impl Fn(&mut RenderSettings)) -> Picture {
    let text = scene_text(looks_at);
    let mut loaded = sound(scene::parse(Path::new("bounces.toml"), text.as_bytes()));
    assert_eq!(loaded.settings.max_bounces, 0);
    change(&mut loaded.settings);
    render_on(wanted, &loaded.scene, &loaded.settings)
}

/// Largest relative deviation of a pixel from the closed form.
fn deviation(picture: &Picture) -> f64 {
    let exact = [3.0, 2.0, 1.0].map(|intensity| 0.6 * intensity / (PI * 1.5 * 1.5));
    let of = |rgb: &[f32; 3]| {
        (0..3).map(|c| (f64::from(rgb[c]) / exact[c] - 1.0).abs()).fold(0.0, f64::max)
    };
    picture.rgb.iter().map(of).fold(0.0, f64::max)
}

#[test]
fn direct_light_is_left() {
    for method in [Method::Sppm, Method::Ppm] {
        let sampled = deviation(&render("grey", &Wanted::Cpu, |s| s.method = method));
        assert!(sampled < 1e-4, "{method:?}: {sampled}");
        let photons = |s: &mut RenderSettings| (s.method, s.direct) = (method, Direct::Photons);
        // 4 x 200 000 photons over 4 pi 1.5^2, times the disc's pi 0.05^2: 222 on average, 6.7 % of
        // one sigma.
        let by_photons = deviation(&render("grey", &Wanted::Cpu, photons));
        assert!(by_photons < 0.3, "{method:?}: {by_photons}");
    }
    // One more bounce adds the wall's light, which the comparison detects.
    let one = deviation(&render("grey", &Wanted::Cpu, |s| s.max_bounces = 1));
    assert!(one > 0.05, "{one}");
}

#[test]
fn nothing_is_seen_by_a_mirror_and_path_tracing_sees_lights_alone() {
    let black = |picture: Picture| picture.rgb.iter().flatten().all(|&value| value == 0.0);
    assert!(black(render("chrome", &Wanted::Cpu, |_| ())));
    assert!(!black(render("chrome", &Wanted::Cpu, |s| s.max_bounces = 1)));
    let path = |max_bounces| {
        move |s: &mut RenderSettings| (s.method, s.max_bounces) = (Method::Path, max_bounces)
    };
    assert!(black(render("grey", &Wanted::Cpu, path(0))));
    assert!(deviation(&render("grey", &Wanted::Cpu, path(1))) < 1e-4);
}

/// The software driver gives the same bits, although a photon's key has no bits for the bounce
/// here.
#[test]
fn engines_agree() {
    for direct in [Direct::Sampled, Direct::Photons] {
        let [cpu, software] = [Wanted::Cpu, Wanted::Software]
            .map(|wanted| render("grey", &wanted, |s| s.direct = direct).rgb);
        assert!(cpu.iter().flatten().any(|&value| value > 0.0));
        assert_eq!(cpu, software, "{direct:?}");
    }
}
