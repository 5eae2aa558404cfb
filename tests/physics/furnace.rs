//! Furnace tests: scenes in which the radiance is the same everywhere, or in which a body must be
//! invisible.

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use glam::DVec3;

use super::lab::*;

/// Theory: in a closed room whose walls all emit Le and reflect rho, L = Le + rho L, so L = Le /
/// (1 - rho) everywhere, whatever the room's form. Cut off after b scatterings it is Le
/// (1 - rho^(b+1)) / (1 - rho). Every shape that can emit is a wall here: a room inside a box would
/// emit outward, so six rectangles close it and the others stand in it.
#[test]
fn closed_room() {
    const EMISSION: f64 = 0.25;
    const ALBEDO: f64 = 0.6;
    let mesh = file("physics-cube.obj", CUBE.as_bytes());
    let view =
        |target, fov| Camera { position: DVec3::new(0.2, 0.8, 1.8), target, fov, size: 12 }.toml();
    let mut text = format!("[materials.wall]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n");
    let shapes = [
        "type = \"rectangle\"\norigin = [-2, -1, -2]\nu = [0, 0, 4]\nv = [4, 0, 0]",
        "type = \"rectangle\"\norigin = [-2, 1, -2]\nu = [4, 0, 0]\nv = [0, 0, 4]",
        "type = \"rectangle\"\norigin = [-2, -1, -2]\nu = [4, 0, 0]\nv = [0, 2, 0]",
        "type = \"rectangle\"\norigin = [-2, -1, 2]\nu = [0, 2, 0]\nv = [4, 0, 0]",
        "type = \"rectangle\"\norigin = [-2, -1, -2]\nu = [0, 2, 0]\nv = [0, 0, 4]",
        "type = \"rectangle\"\norigin = [2, -1, -2]\nu = [0, 0, 4]\nv = [0, 2, 0]",
        "type = \"sphere\"\ncenter = [-0.6, -0.3, 0]\nradius = 0.4",
        "type = \"box\"\nmin = [0.3, -0.9, -0.5]\nmax = [0.8, -0.2, 0.2]",
        "type = \"revolution\"\nsegments = [[[0, 0], [0.3, 0]], [[0.3, 0], [0.6, 0.4], [0, 0.6]]]\ntransform = { translate = [-0.2, -0.8, 0.7] }",
        &format!(
            "type = \"mesh\"\nfile = \"{mesh}\"\n\
             transform = {{ scale = 0.4, rotate = {{ axis = [1, 1, 0], degrees = 30 }}, translate = [0.8, 0.1, 0.5] }}"
        ),
    ];
    for shape in shapes {
        text += &format!("[[shapes]]\n{shape}\nmaterial = \"wall\"\nemission = {EMISSION}\n");
    }
    let truth = vec![EMISSION / (1.0 - ALBEDO); 144];
    // the whole room by path tracing; photons, whose discs lose light at edges, on a wall and on
    // the ball
    let room = view(DVec3::new(0.0, -0.2, 0.0), 60.0) + &text;
    let path = RenderSettings { method: Method::Path, passes: 4, ..settings(0.02) };
    runs_to(0.03, &room, &path).assert_picture("room, Path", &truth, 0.03);
    for (place, target, fov) in
        [("wall", DVec3::new(-0.3, 0.7, -2.0), 9.0), ("ball", DVec3::new(-0.6, -0.2, 0.0), 9.0)]
    {
        for direct in DIRECT {
            let settings = RenderSettings { direct, passes: 4, photons: 1 << 14, ..settings(0.05) };
            let text = view(target, fov) + &text;
            runs_to(0.08, &text, &settings).assert_picture(
                &format!("{place} of the room, {direct:?}"),
                &truth,
                0.08,
            );
        }
    }
}

const CUBE: &str = "v -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv 0.5 0.5 -0.5\nv -0.5 0.5 -0.5
v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n";

/// The scene: a body alone in light of radiance 1 from everywhere, filling most of the image.
fn in_constant_light(body: &str) -> String {
    let camera =
        Camera { position: DVec3::new(0.4, 1.1, 3.0), target: DVec3::ZERO, fov: 34.0, size: 12 };
    camera.toml() + "[environment]\nradiance = 1.0\n" + body
}

/// Bodies of every shape around the origin, of one material.
fn bodies() -> Vec<(&'static str, String)> {
    let mesh = file("physics-furnace-cube.obj", CUBE.as_bytes());
    vec![
        ("sphere", "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.8".into()),
        ("box", "type = \"box\"\nmin = [-0.6, -0.5, -0.7]\nmax = [0.6, 0.4, 0.5]".into()),
        (
            "revolution",
            "type = \"revolution\"\n\
          profile = [[0, 0], [0.9, 0], [0.7, 0.8], [0.1, 0.8], [0, 1.3]]\n\
          transform = { translate = [0, -0.6, 0] }"
                .into(),
        ),
        (
            "mesh",
            format!(
                "type = \"mesh\"\nfile = \"{mesh}\"\nsmooth = false\n\
          transform = {{ scale = 1.2, rotate = {{ axis = [1, 2, 0], degrees = 35 }} }}"
            ),
        ),
    ]
}

/// Theory: a body that absorbs nothing only reflects and refracts radiance 1, so radiance 1 comes
/// out (the factor (n_i / n_t)^2 on the way in is undone on the way out). In constant light mirrors
/// and clear glass are invisible. Light inside for more bounces than allowed would be lost;
/// roulette must not lose it either.
#[test]
fn mirrors_and_glass_are_invisible() {
    for (name, body) in bodies() {
        for (kind, material) in [
            ("mirror", "type = \"mirror\"\nreflectance = 1.0"),
            ("glass", "type = \"glass\"\nior = 1.5"),
        ] {
            let text = in_constant_light(&format!(
                "[materials.m]\n{material}\n[[shapes]]\n{body}\nmaterial = \"m\"\n"
            ));
            for method in [Method::Sppm, Method::Path] {
                let settings = RenderSettings {
                    method,
                    passes: 8,
                    photons: 1,
                    max_bounces: 1000,
                    ..settings(0.02)
                };
                // the path tracer's roulette is noisier inside glass, where radiance is lower
                let power = if method == Method::Path { 0.02 } else { 0.002 };
                let what = format!("{kind} {name}, {method:?}");
                runs_to(power, &text, &settings).assert_picture(&what, &[1.0; 144], power);
            }
        }
    }
}

/// Theory: a convex diffuse body in constant light L has E = pi L everywhere, so its radiance is
/// rho L; the background is L.
#[test]
fn diffuse_bodies() {
    const ALBEDO: f64 = 0.5;
    for (name, body) in &bodies()[..2] {
        let camera = Camera {
            position: DVec3::new(0.4, 1.1, 3.0),
            target: DVec3::new(0.1, 0.1, 0.5),
            fov: 9.0,
            size: 12,
        };
        let text = camera.toml()
            + &format!(
                "[environment]\nradiance = 1.0\n[materials.m]\ntype = \"diffuse\"\n\
                 reflectance = {ALBEDO}\n\
                 [[shapes]]\n{body}\nmaterial = \"m\"\n"
            );
        for (method, direct) in [
            (Method::Sppm, Direct::Sampled),
            (Method::Ppm, Direct::Photons),
            (Method::Path, Direct::Photons),
        ] {
            let settings =
                RenderSettings { method, direct, passes: 2, photons: 1 << 14, ..settings(0.03) };
            let what = format!("diffuse {name}, {method:?} {direct:?}");
            runs_to(0.06, &text, &settings).assert_picture(&what, &[ALBEDO; 144], 0.06);
        }
    }
}

/// Theory: a plane of GGX metal with reflectance 1 in constant light is as bright as the light,
/// because light that one facet sends to another is added. (Single scattering alone keeps 0.32 of
/// it at roughness 1; Heitz et al. 2016.) The same holds for a white base below any coat.
#[test]
fn white_metals_and_plastics_lose_nothing() {
    let metal =
        |roughness: f64| format!("type = \"metal\"\nreflectance = 1.0\nroughness = {roughness:?}");
    let plastic = |roughness: f64, nonlinear: bool| {
        format!(
            "type = \"plastic\"\nreflectance = 1.0\nior = 1.6\nroughness = {roughness:?}\n\
             nonlinear = {nonlinear}"
        )
    };
    let principled = |keys: &str| format!("type = \"principled\"\nbase_color = 1.0\n{keys}");
    for (material, elevation) in [
        (principled("metallic = 0.4\nroughness = 0.5"), 40.0f64),
        (principled("specular = 0.5\nroughness = 0.7"), 20.0),
        (principled("clearcoat = 1.0\nroughness = 0.9"), 45.0),
        (principled("clearcoat = 0.6\nclearcoat_roughness = 0.2\nspecular = 0.3"), 70.0),
        // the light scattered several times is a mean over the azimuth
        ("type = \"metal\"\nreflectance = 1.0\nroughness = [0.5, 0.7]".to_owned(), 50.0),
        (metal(0.3), 60.0),
        (metal(0.7), 35.0),
        (metal(1.0), 50.0),
        (metal(1.0), 12.0),
        (plastic(0.0, false), 50.0),
        (plastic(0.0, true), 15.0),
        (plastic(0.4, true), 50.0),
        (plastic(0.8, false), 15.0),
    ] {
        let (sin, cos) = elevation.to_radians().sin_cos();
        // a narrow view, nearly one direction
        let camera = Camera {
            position: DVec3::new(0.0, 4.0 * sin, 4.0 * cos),
            target: DVec3::ZERO,
            fov: 6.0,
            size: 8,
        };
        let text = camera.toml()
            + &format!(
                "[environment]\nradiance = 1.0\n[materials.m]\n{material}\n[[shapes]]\n\
                 type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3.0\n\
                 material = \"m\"\n"
            );
        let narrow =
            !material.contains("roughness = 1.0") && !material.contains("type = \"plastic");
        for (method, direct) in [
            (Method::Sppm, Direct::Sampled),
            (Method::Sppm, Direct::Photons),
            (Method::Path, Direct::Photons),
        ] {
            if direct == Direct::Photons && method == Method::Sppm && narrow {
                continue; // photons seldom arrive within so narrow a lobe
            }
            let settings =
                RenderSettings { method, direct, passes: 4, photons: 1 << 14, ..settings(0.05) };
            let found = runs_to(0.02, &text, &settings).region(|_, _| true);
            let what = format!("{material} at {elevation} degrees, {method:?} {direct:?}");
            assert_agrees(&what, found, 1.0, 0.02);
        }
    }
}

/// Theory: the same for balls of rough glass, within 1 %: what one side reflects the other side
/// lets pass, and radiance over the squared index is conserved on every path through the ball.
#[test]
fn rough_glass_loses_nothing() {
    for roughness in [0.3, 0.8] {
        let camera = Camera {
            position: DVec3::new(0.4, 1.1, 3.0),
            target: DVec3::ZERO,
            fov: 14.0,
            size: 24,
        };
        let text = format!(
            "{}[environment]\nradiance = 1.0\n[materials.m]\ntype = \"glass\"\nior = 1.5\n\
             roughness = {roughness:?}\n[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\n\
             radius = 0.8\nmaterial = \"m\"\n",
            camera.toml()
        );
        // at the higher roughness, SPPM would gather, which is slow to converge inside a ball
        let methods = [(Method::Path, Direct::Photons), (Method::Sppm, Direct::Sampled)];
        for (method, direct) in methods.into_iter().take(if roughness < 0.5 { 2 } else { 1 }) {
            let settings = RenderSettings {
                method,
                direct,
                passes: 8,
                photons: 1,
                max_bounces: 1000,
                ..settings(0.03)
            };
            let found = runs_to(0.01, &text, &settings).region(|_, _| true);
            let what = format!("roughness {roughness}, {method:?}");
            // the fraction that facets scatter once is a polynomial
            assert!((found.mean - 1.0).abs() < 0.01, "{what}: {found:?}");
            assert!(found.error < 0.003, "{what}: {found:?}");
        }
    }
}
