//! Glass: Fresnel reflection, absorption, and cameras, lights and other bodies inside it.

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use glam::DVec3;

use super::lab::*;

const SPECULAR: [Method; 2] = [Method::Sppm, Method::Path];

/// Settings for eye paths only: the image needs no photon.
fn seen(method: Method) -> RenderSettings {
    RenderSettings { method, passes: 32, photons: 1, max_bounces: 200, ..settings(0.02) }
}

fn cube(size: f64) -> String {
    let h = 0.5 * size;
    let corner = |k: u32| [0, 1, 2].map(|b| if k >> b & 1 == 1 { h } else { -h });
    let mut obj = String::new();
    (0..8).map(corner).for_each(|c| obj += &format!("v {} {} {}\n", c[0], c[1], c[2]));
    obj + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// Bodies whose chord through the origin along z is 1.2 long.
fn bodies() -> Vec<(&'static str, String)> {
    let mesh = file("physics-glass-cube.obj", cube(1.2).as_bytes());
    vec![
        ("sphere", "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.6".into()),
        ("box", "type = \"box\"\nmin = [-0.5, -0.7, -0.6]\nmax = [0.8, 0.6, 0.6]".into()),
        (
            "revolution",
            "type = \"revolution\"\n\
          segments = [[[0, -0.5], [0.6, -0.5]], [[0.6, -0.5], [0.6, 0.5]], [[0.6, 0.5], [0, 0.5]]]"
                .into(),
        ),
        ("mesh", format!("type = \"mesh\"\nfile = \"{mesh}\"\nsmooth = false")),
    ]
}

fn glass(body: &str, ior: f64, absorption: f64) -> String {
    format!(
        "[materials.glass]\ntype = \"glass\"\nior = {ior:?}\nabsorption = {absorption:?}\n\
         [[shapes]]\n{body}\nmaterial = \"glass\"\n"
    )
}

/// A narrow view along -z through the origin onto a constant sky.
fn along_z() -> String {
    let camera =
        Camera { position: DVec3::new(0.0, 0.0, 3.0), target: DVec3::ZERO, fov: 0.5, size: 8 };
    camera.toml() + "[environment]\nradiance = 1.0\n"
}

/// Theory: with index 1 nothing is reflected, so radiance 1 arrives times exp(-sigma d)
/// (Beer-Lambert).
#[test]
fn beer_lambert() {
    for (name, body) in bodies() {
        for sigma in [0.0, 0.5, 2.0] {
            let text = along_z() + &glass(&body, 1.0, sigma);
            for method in SPECULAR {
                let truth = vec![(-sigma * 1.2f64).exp(); 64];
                // roulette decides about dim light
                let power = if sigma < 1.0 { 0.002 } else { 0.06 };
                let what = format!("{name}, sigma {sigma}, {method:?}");
                runs_to(power, &text, &seen(method)).assert_picture(&what, &truth, power);
            }
        }
    }
}

/// Theory: a slab has reflectance R at each face, and all light reflected inside gets out. With a =
/// exp(-sigma d) it transmits (1 - R)^2 a / (1 - R^2 a^2) and reflects R + R (1 - R)^2 a^2 / (1 -
/// R^2 a^2). Without absorption that is (1 - R) / (1 + R) and 2 R / (1 + R). A bright wall in front
/// of or behind the slab separates the two. The factor 1 / n^2 on the way in is undone on the way
/// out. The same holds for rough faces as the roughness goes to 0.
#[test]
fn slab() {
    for (ior, sigma) in [(1.5f64, 0.7), (2.4, 0.0), (1.0 / 1.5, 0.0)] {
        let r = ((ior - 1.0) / (ior + 1.0)).powi(2);
        {
            let a = (-sigma * 0.5f64).exp();
            let inside = (1.0 - r).powi(2) / (1.0 - r * r * a * a);
            let (through, back) = (inside * a, r + r * inside * a * a);
            for (emission, truth, name) in
                [([1.0, 0.0], through, "through"), ([0.0, 1.0], back, "back")]
            {
                let camera = Camera {
                    position: DVec3::new(0.0, 0.0, 2.0),
                    target: DVec3::ZERO,
                    fov: 0.5,
                    size: 8,
                };
                let mut text = camera.toml()
                    + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n"
                    + &glass(
                        "type = \"box\"\nmin = [-9, -9, -0.25]\nmax = [9, 9, 0.25]",
                        ior,
                        sigma,
                    );
                for (z, normal, e) in [(-2.0, 1.0, emission[0]), (3.0, -1.0, emission[1])] {
                    text += &format!(
                        "[[shapes]]\ntype = \"disc\"\ncenter = [0, 0, {z}]\n\
                         normal = [0, 0, {normal}]\nradius = 9\nmaterial = \"black\"\n\
                         emission = {e:?}\n"
                    );
                }
                // facets this narrow scatter as a smooth face does
                let rough = text.replace("\"glass\"\nior", "\"glass\"\nroughness = 0.03\nior");
                assert_ne!(text, rough);
                for (text, face) in [(&text, "smooth"), (&rough, "rough")] {
                    for method in SPECULAR {
                        let what = format!("{face} slab {name}, ior {ior:.3}, {method:?}");
                        let settings = seen(method);
                        runs_to(0.05, text, &settings).assert_picture(&what, &[truth; 64], 0.05);
                    }
                }
            }
        }
    }
}

/// Theory: Snell's and Fresnel's laws at 60 degrees, unpolarised: R = (R_s + R_p) / 2, for one face
/// alone (a disc of glass with nothing behind it that reflects light).
#[test]
fn fresnel_at_an_angle() {
    let (cos_i, n) = (0.5f64, 1.5f64);
    let cos_t = (1.0 - 0.75 / (n * n)).sqrt();
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    let truth = 0.5 * (s * s + p * p);
    let d = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
    let camera = Camera { position: d * 2.0, target: DVec3::ZERO, fov: 0.1, size: 8 };
    let text = camera.toml()
        + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n"
        + &glass("type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 1", n, 0.0)
        + &format!(
            "[[shapes]]\ntype = \"disc\"\ncenter = {}\nnormal = {}\nradius = 1\n\
             material = \"black\"\nemission = 1.0\n",
            list(DVec3::new(-d.x, d.y, 0.0) * 3.0),
            list(DVec3::new(d.x, -d.y, 0.0))
        );
    for method in SPECULAR {
        runs_to(0.02, &text, &seen(method)).assert_picture(
            &format!("Fresnel, {method:?}"),
            &[truth; 64],
            0.02,
        );
    }
}

/// Theory: from inside an absorbing body of index 1, radiance 1 outside is attenuated along the
/// remaining distance only.
#[test]
fn camera_inside_glass() {
    let camera =
        Camera { position: DVec3::new(0.0, 0.0, 0.2), target: DVec3::ZERO, fov: 0.5, size: 8 };
    for (name, body) in bodies() {
        let text = camera.toml() + "[environment]\nradiance = 1.0\n" + &glass(&body, 1.0, 1.0);
        for method in SPECULAR {
            let truth = vec![(-0.8f64).exp(); 64];
            runs(&text, &seen(method)).assert_picture(
                &format!("camera in a {name}, {method:?}"),
                &truth,
                0.002,
            );
        }
    }
}

/// Theory: radiance over the squared index is constant along a ray, and light reflected inside a
/// clear body comes from everywhere. So in constant light 1 the radiance inside is n^2.
#[test]
fn camera_inside_clear_glass() {
    let camera =
        Camera { position: DVec3::new(0.0, 0.0, 0.2), target: DVec3::ZERO, fov: 5.0, size: 8 };
    for (name, body) in bodies() {
        let text = camera.toml() + "[environment]\nradiance = 1.0\n" + &glass(&body, 1.5, 0.0);
        for method in SPECULAR {
            let what = format!("camera in a clear {name}, {method:?}");
            runs_to(0.02, &text, &seen(method)).assert_picture(&what, &[2.25; 64], 0.02);
        }
    }
}

/// Theory: camera, floor and point light lie inside one absorbing body of index 1: E = I h / d^3
/// exp(-sigma d), and the distance c to the camera attenuates by exp(-sigma c). Glass that emits
/// from outside must not change that.
#[test]
fn all_inside_glass() {
    const SIGMA: f64 = 0.8;
    let camera =
        Camera { position: DVec3::new(0.0, 1.6, 3.0), target: DVec3::ZERO, fov: 6.0, size: 8 };
    let at = DVec3::new(0.1, 0.5, -0.1);
    let text = camera.toml()
        + &glass("type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 6.0", 1.0, SIGMA)
        + "[materials.floor]\ntype = \"diffuse\"\nreflectance = 0.6\n[[shapes]]\ntype = \"disc\"\n\
           center = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 1\nmaterial = \"floor\"\n"
        + &format!("[[lights]]\ntype = \"point\"\nposition = {}\nintensity = 2.0\n", list(at));
    let blur = |direct| if direct == Direct::Photons { 0.03 } else { 0.0 };
    let picture = |direct| {
        camera.floor_picture(blur(direct), |p| {
            let d = (at - p).length();
            let c = (camera.position - p).length();
            0.6 / std::f64::consts::PI * 2.0 * at.y / d.powi(3) * (-SIGMA * (d + c)).exp()
        })
    };
    for (method, direct) in [
        (Method::Sppm, Direct::Sampled),
        (Method::Sppm, Direct::Photons),
        (Method::Path, Direct::Sampled),
    ] {
        let settings =
            RenderSettings { method, direct, passes: 8, photons: 1 << 14, ..settings(0.03) };
        runs_to(0.04, &text, &settings).assert_picture(
            &format!("inside, {method:?} {direct:?}"),
            &picture(direct),
            0.04,
        );
    }
}

/// Theory: an absorbing ball of index 1 about a point light dims it by exp(-sigma R) and nothing
/// else; only photons get through glass, in either direct mode.
#[test]
fn light_inside_glass() {
    let camera =
        Camera { position: DVec3::new(0.0, 1.6, 3.0), target: DVec3::ZERO, fov: 6.0, size: 8 };
    let at = DVec3::new(0.1, 0.5, -0.1);
    let text = camera.toml()
        + &glass(&format!("type = \"sphere\"\ncenter = {}\nradius = 0.2", list(at)), 1.0, 3.0)
        + "[materials.floor]\ntype = \"diffuse\"\nreflectance = 0.6\n[[shapes]]\ntype = \"disc\"\n\
           center = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 1\nmaterial = \"floor\"\n"
        + &format!("[[lights]]\ntype = \"point\"\nposition = {}\nintensity = 2.0\n", list(at));
    let truth = camera.floor_picture(0.03, |p| {
        0.6 / std::f64::consts::PI * 2.0 * at.y / (at - p).length().powi(3) * (-0.6f64).exp()
    });
    for direct in DIRECT {
        let settings = RenderSettings { direct, passes: 8, photons: 1 << 14, ..settings(0.03) };
        runs_to(0.04, &text, &settings).assert_picture(
            &format!("light in a ball, {direct:?}"),
            &truth,
            0.04,
        );
    }
}

/// Theory: a slab of index n transmits (1 - R) / (1 + R), R = ((n - 1) / (n + 1))^2: all but 5e-13
/// at n = 1.000001, 2e-6 at n = 1e6, which reflects the rest. At n = 1 the picture is that of the
/// empty scene, to the bit.
#[test]
fn extreme_indices() {
    let scene = |glass: &str, emission: [f64; 2]| {
        let camera =
            Camera { position: DVec3::new(0.0, 0.0, 2.0), target: DVec3::ZERO, fov: 40.0, size: 8 };
        let mut text =
            camera.toml() + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n" + glass;
        for (z, normal, e) in [(-2.0, 1.0, emission[0]), (3.0, -1.0, emission[1])] {
            text += &format!(
                "[[shapes]]\ntype = \"disc\"\ncenter = [0, 0, {z}]\nnormal = [0, 0, {normal}]\n\
                 radius = 90\nmaterial = \"black\"\nemission = {e:?}\n"
            );
        }
        text
    };
    let slab =
        |ior| glass("type = \"box\"\nmin = [-90, -90, -0.25]\nmax = [90, 90, 0.25]", ior, 0.0);
    for method in SPECULAR {
        let picture = |text: &str| render(&parse(text), &seen(method)).rgb;
        for emission in [[1.0, 0.0], [0.0, 1.0]] {
            let empty = picture(&scene("", emission));
            assert_eq!(
                picture(&scene(&slab(1.0), emission)),
                empty,
                "{method:?} {emission:?}: index 1"
            );
            let thin = picture(&scene(&slab(1.000001), emission));
            for (a, b) in thin.iter().zip(&empty) {
                assert!(
                    (a[0] - b[0]).abs() < 1e-5,
                    "{method:?} {emission:?}, index 1.000001: {a:?} for {b:?}"
                );
            }
            // of 2,048 paths one with a probability of 2e-5 is rarely seen
            let dense = picture(&scene(&slab(1e6), emission));
            for a in dense {
                let off = (f64::from(a[0]) - emission[1]).abs();
                assert!(off < 0.05, "{method:?} {emission:?}, index 1e6: {a:?}");
            }
        }
    }
}

/// Theory: two slabs that touch are one. Between glass and the same glass there is no interface, so
/// both together transmit (1 - R) / (1 + R), not the (1 - R) / (1 + 3 R) of two slabs with air
/// between. Glass 2 on glass 1 has the three interfaces 1 : n1 : n2 : 1, which transmit, with
/// multiple reflections, 1 / (1 + sum R_i / (1 - R_i)) (reflectances of plates add like resistances
/// R / (1 - R)). A body inside another is entered from the outer glass likewise.
#[test]
fn glass_on_glass() {
    let resistance = |a: f64, b: f64| {
        let r = ((a - b) / (a + b)).powi(2);
        r / (1.0 - r)
    };
    let through = |indices: &[f64]| {
        1.0 / (1.0 + indices.windows(2).map(|w| resistance(w[0], w[1])).sum::<f64>())
    };
    let slab = |name: &str, ior: f64, from: f64, to: f64, half: f64| {
        format!(
            "[materials.{name}]\ntype = \"glass\"\nior = {ior:?}\n\
             [[shapes]]\ntype = \"box\"\nmin = [-{half}, -{half}, {from}]\n\
             max = [{half}, {half}, {to}]\nmaterial = \"{name}\"\n"
        )
    };
    for (name, bodies, indices) in [
        ("one", slab("a", 2.0, -0.25, 0.25, 9.0), vec![1.0, 2.0, 1.0]),
        (
            "two that touch",
            slab("a", 2.0, -0.25, 0.1, 9.0) + &slab("b", 2.0, 0.1, 0.25, 9.0),
            vec![1.0, 2.0, 1.0],
        ),
        (
            "two of which the other comes first",
            slab("b", 2.0, 0.1, 0.25, 9.0) + &slab("a", 2.0, -0.25, 0.1, 9.0),
            vec![1.0, 2.0, 1.0],
        ),
        (
            "two kinds",
            slab("a", 1.5, -0.25, 0.1, 9.0) + &slab("b", 2.5, 0.1, 0.25, 9.0),
            vec![1.0, 2.5, 1.5, 1.0],
        ),
        (
            "one in another",
            slab("a", 1.5, -0.5, 0.5, 9.0) + &slab("b", 2.5, -0.1, 0.1, 8.0),
            vec![1.0, 1.5, 2.5, 1.5, 1.0],
        ),
        (
            "two apart",
            slab("a", 2.0, -0.25, -0.1, 9.0) + &slab("b", 2.0, 0.1, 0.25, 9.0),
            vec![1.0, 2.0, 1.0, 2.0, 1.0],
        ),
    ] {
        let camera =
            Camera { position: DVec3::new(0.0, 0.0, 2.0), target: DVec3::ZERO, fov: 0.5, size: 8 };
        let text = camera.toml()
            + "[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n"
            + &bodies
            + "[[shapes]]\ntype = \"disc\"\ncenter = [0, 0, -2]\nnormal = [0, 0, 1]\nradius = 9\n\
               material = \"black\"\nemission = 1.0\n";
        for method in SPECULAR {
            let truth = [through(&indices); 64];
            let what = format!("{name}, {method:?}");
            runs_to(0.02, &text, &seen(method)).assert_picture(&what, &truth, 0.02);
        }
    }
}

/// Theory: from inside glass of index n, total reflection begins where sin = 1 / n. A few roundings
/// on either side of that angle the reflectance is that of Fresnel's equations in f64, at a squared
/// cosine of the refracted ray that is off by only a few roundings of 1, and exactly 1 beyond. The
/// refracted ray is a direction. In dense glass the reflectance falls from 1 to Brewster's angle
/// within a short and steep range, where `1 - cos^2` would have no digits left.
#[test]
fn critical_angle() {
    use caustica::low_level::materials::fresnel::fresnel;
    use caustica::low_level::materials::fresnel::refracted;
    use glam::Vec3;
    const ROUNDINGS: f64 = 6.0 * 6e-8;
    let exact = |cos: f64, n: f64, off: f64| {
        let cos_t_sq = 1.0 - n * n * (1.0 - cos) * (1.0 + cos) + off;
        if cos_t_sq <= 0.0 {
            return 1.0;
        }
        let cos_t = cos_t_sq.sqrt();
        let p = (cos - n * cos_t) / (cos + n * cos_t);
        let s = (n * cos - cos_t) / (n * cos + cos_t);
        0.5 * (p * p + s * s)
    };
    for n in [1.000001f32, 1.1, 1.33, 1.5, 2.4, 100.0, 1e6] {
        let wide = f64::from(n);
        let critical = (1.0 - 1.0 / (wide * wide)).sqrt() as f32;
        for ulps in -40..=40i32 {
            let cos = f32::from_bits(critical.to_bits().wrapping_add_signed(ulps)).min(1.0);
            let interface = fresnel(cos, n);
            let near: Vec<f64> = (-20..=20)
                .map(|k| exact(f64::from(cos), wide, ROUNDINGS * f64::from(k) / 20.0))
                .collect();
            let (low, high) =
                near.iter().fold((1.0f64, 0.0f64), |(l, h), r| (l.min(*r), h.max(*r)));
            let r = f64::from(interface.reflectance);
            assert!(
                r >= low - 1e-6 && r <= high + 1e-6,
                "n {n}, {ulps} ulps: {r} not in {low} .. {high}"
            );
            if r < 1.0 {
                let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), cos, 0.0);
                let wi = refracted(wo, Vec3::Y, cos, interface.cos_t, n);
                assert!(wi.is_finite() && wi.y <= 1e-6, "n {n}, {ulps} ulps: {wi}");
                assert!((wi.length() - 1.0).abs() < 1e-5, "n {n}, {ulps} ulps: {wi}");
            }
        }
    }
    assert_eq!(fresnel(0.7, 1.5).reflectance, 1.0);
}
