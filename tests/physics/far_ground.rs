//! Endless ground under light from infinity: an upright wall receives light from near and distant
//! ground.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Method, RenderSettings};
use glam::DVec3;

use super::lab::*;

const WALL: f64 = 0.6;
const GROUND: f64 = 0.5;
const SUN: f64 = 3.0;
const SKY: f64 = 0.8;

/// The scene: a small upright wall at height `h` above `ground`, and the camera in front of it.
fn scene(h: f64, ground: &str, light: &str) -> String {
    let (position, target) = (DVec3::new(0.0, h, 1.5), DVec3::new(0.0, h, 0.0));
    Camera { position, target, fov: 7.0, size: 8 }.toml()
        + &format!(
            "[materials.wall]\ntype = \"diffuse\"\nreflectance = {WALL}\n\
             [materials.ground]\ntype = \"diffuse\"\nreflectance = {GROUND}\n\
             [[shapes]]\ntype = \"rectangle\"\norigin = [-0.2, {}, 0]\nu = [0.4, 0, 0]\n\
             v = [0, 0.4, 0]\nmaterial = \"wall\"\n\
             [[shapes]]\n{ground}\nmaterial = \"ground\"\n{light}\n",
            h - 0.2
        )
}

/// Theory: an upright wall sees an endless floor of radiance B with the form factor 1/2, so E = pi
/// B / 2 in addition to light from above. A sun straight overhead casts no shadow of the wall and
/// no light on it: B = rho E_sun / pi. A sky of radiance L gives B = rho L and adds pi L / 2
/// itself. Half of the light comes from ground farther away than the wall is high. The ground ends
/// at 1e4 of the scene's size (planes) or at its horizon, which costs less than 1e-3. The wall
/// hides less than 4e-4 of the sky from the ground below it.
#[test]
fn wall_above() {
    let plane = "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]";
    let globe = "type = \"sphere\"\ncenter = [0, -1e8, 0]\nradius = 1e8";
    let sun = format!("[[lights]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = {SUN}");
    let sky = format!("[environment]\nradiance = {SKY}");
    let sunlit = (0.5 * GROUND * SUN, 0.0);
    let skylit = (0.5 * PI * GROUND * SKY, 0.5 * PI * SKY);
    // the near wall stands within the scene's bounding sphere, the high ones above it
    for (name, h, ground, light, (from_ground, from_above)) in [
        ("near wall, plane, sun", 0.7, plane, &sun, sunlit),
        ("high wall, plane, sun", 12.0, plane, &sun, sunlit),
        ("high wall, globe, sun", 12.0, globe, &sun, sunlit),
        ("high wall, plane, sky", 12.0, plane, &sky, skylit),
    ] {
        let text = scene(h, ground, light);
        let truth = [WALL / PI * (from_ground + from_above); 64];
        let settings = RenderSettings { photons: 1 << 13, ..settings(0.07) };
        for direct in if from_above > 0.0 { &DIRECT[..] } else { &DIRECT[..1] } {
            let settings = RenderSettings { direct: *direct, ..settings.clone() };
            runs_to(0.08, &text, &settings).assert_picture(
                &format!("{name}, {direct:?}"),
                &truth,
                0.08,
            );
        }
        let path = RenderSettings { method: Method::Path, passes: 16, ..settings };
        runs_to(0.08, &text, &path).assert_picture(&format!("{name}, path"), &truth, 0.08);
    }
}
