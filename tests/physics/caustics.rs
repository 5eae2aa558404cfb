//! Caustics in closed form.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Direct, RadiusRule, RenderSettings};
use glam::DVec3;

use super::lab::*;

/// So dark that light which the floor reflects to mirror or glass and receives back contributes
/// less than a thousandth.
const ALBEDO: f64 = 0.002;
const RADIUS: f64 = 0.03;

/// The floor y = 0 and its camera.
fn floor(camera: &Camera) -> String {
    camera.toml()
        + &format!(
            "[materials.floor]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n[materials.black]\n\
             type = \"diffuse\"\nreflectance = 0.0\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3\n\
             material = \"floor\"\n"
        )
}

/// Theory: a paraboloid y = r^2 / 4f makes the light of a point at its focus parallel. A ring of
/// the mirror at radius r subtends the solid angle 2 pi sin(theta) dtheta with r = 2 f tan(theta /
/// 2), so E(r) = (I / f^2) / (1 + r^2 / 4f^2)^2 on any plane across the axis. The mirror hangs
/// upside down over the floor, and a disc between lamp and floor blocks direct light (its shadow
/// falls inside r < 0.2). The quadratic profile (0, 0), (a/2, 0), (a, a^2/4f) is exactly that
/// paraboloid.
#[test]
fn paraboloid_mirror() {
    const F: f64 = 0.5;
    const A: f64 = 1.2;
    const I: f64 = 2.0;
    const TOP: f64 = 1.6;
    let camera = Camera {
        position: DVec3::new(0.6, 1.7, 4.0),
        target: DVec3::new(0.6, 0.0, 0.0),
        fov: 6.0,
        size: 16,
    };
    let text = floor(&camera)
        + &format!(
            "[materials.mirror]\ntype = \"mirror\"\nreflectance = 1.0\n\
             [[shapes]]\ntype = \"revolution\"\nprofile = [[0, 0], [{}, 0], [{A}, {}]]\n\
             material = \"mirror\"\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], degrees = 180 }}, translate = [0, {TOP}, 0] }}\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, {}, 0]\nnormal = [0, 1, 0]\nradius = 0.2\n\
             material = \"black\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {}, 0]\nintensity = {I}\n",
            0.5 * A,
            A * A / (4.0 * F),
            TOP - F - 0.02,
            TOP - F
        );
    for (direct, radius_rule) in
        [(Direct::Sampled, RadiusRule::Fixed), (Direct::Photons, RadiusRule::Global)]
    {
        let truth = camera.floor_picture(RADIUS, |p| {
            let r2 = p.x * p.x + p.z * p.z;
            ALBEDO / PI * I / (F * F) / (1.0 + r2 / (4.0 * F * F)).powi(2)
        });
        let settings =
            RenderSettings { direct, radius_rule, passes: 4, photons: 1 << 14, ..settings(RADIUS) };
        runs_to(0.05, &text, &settings).assert_picture(
            &format!("paraboloid, {direct:?}"),
            &truth,
            0.05,
        );
    }
}

/// Theory: rays of a point light at height h that pass a slab of thickness w and index n meet the
/// floor at b(theta) = (h - w) tan(theta) + w tan(theta'), sin(theta) = n sin(theta'), so E(b) = I
/// T sin(theta) / (b db/dtheta) with T = (1 - R)^2. Light reflected inside passes the slab 3, 5,
/// ... times: the same map with 3 w for w and another factor R^2, and so on. R is the mean of both
/// polarisations, because the renderer does not track polarisation.
#[test]
fn slab_over_a_floor() {
    const N: f64 = 1.5;
    const W: f64 = 0.3;
    const H: f64 = 1.0;
    const I: f64 = 2.0;
    let camera =
        Camera { position: DVec3::new(0.0, 0.35, 2.6), target: DVec3::ZERO, fov: 7.0, size: 16 };
    let text = floor(&camera)
        + &format!(
            "[materials.glass]\ntype = \"glass\"\nior = {N:?}\n\
             [[shapes]]\ntype = \"box\"\nmin = [-1.6, 0.5, -1.6]\nmax = [1.6, 0.8, 1.6]\n\
             material = \"glass\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {H}, 0]\nintensity = {I}\n"
        );
    let reflectance = |c: f64, ct: f64| {
        let s = (c - N * ct) / (c + N * ct);
        let p = (N * c - ct) / (N * c + ct);
        0.5 * (s * s + p * p)
    };
    // irradiance at b by light that passed the slab 2 k + 1 times
    let order = |b: f64, k: i32| {
        let ways = W * (2 * k + 1) as f64;
        let place = |theta: f64| (H - W) * theta.tan() + ways * (theta.sin() / N).asin().tan();
        let (mut low, mut high) = (0.0, 1.55);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if place(middle) < b { low = middle } else { high = middle }
        }
        let theta = 0.5 * (low + high);
        let slope = (place(theta + 1e-5) - place(theta - 1e-5)) / 2e-5;
        let ct = (1.0 - (theta.sin() / N).powi(2)).sqrt();
        let r = reflectance(theta.cos(), ct);
        I * (1.0 - r).powi(2) * r.powi(2 * k) * theta.sin() / (b * slope)
    };
    let truth = camera.floor_picture(RADIUS, |p| {
        let b = p.x.hypot(p.z).max(1e-3);
        ALBEDO / PI * (order(b, 0) + order(b, 1) + order(b, 2))
    });
    let settings = RenderSettings { passes: 4, photons: 1 << 14, ..settings(RADIUS) };
    runs_to(0.05, &text, &settings).assert_picture("slab", &truth, 0.05);
}

/// Theory: a ray leaves a source at (0, `h`) at angle theta from straight down and meets the plane
/// y = 0, which defines a one-dimensional map theta -> x (signed). E(b) is the sum of I T
/// sin(theta) / (b |dx/dtheta|) over all theta with |x| = b. `map` returns x and the transmittance
/// T of a ray that arrives.
fn mapped(b: f64, intensity: f64, map: &impl Fn(f64) -> Option<(f64, f64)>) -> f64 {
    const STEPS: usize = 4000;
    const WIDEST: f64 = 0.4;
    let at = |k: usize| (k as f64 + 0.5) * WIDEST / STEPS as f64;
    let mut sum = 0.0;
    for sign in [-1.0, 1.0] {
        let off = |theta: f64| map(theta).map(|(x, _)| sign * x - b);
        for k in 0..STEPS - 1 {
            let (mut low, mut high) = (at(k), at(k + 1));
            let (Some(a), Some(z)) = (off(low), off(high)) else { continue };
            // a discontinuity of the map is not a root
            if a * z > 0.0 || (a - z).abs() > 0.1 {
                continue;
            }
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if off(middle).is_some_and(|m| m * a > 0.0) { low = middle } else { high = middle }
            }
            let theta = 0.5 * (low + high);
            let (Some(right), Some(left), Some((_, t))) =
                (off(theta + 1e-6), off(theta - 1e-6), map(theta))
            else {
                continue;
            };
            sum += intensity * t * theta.sin() / (b * ((right - left) / 2e-6).abs());
        }
    }
    sum
}

/// Theory: the map of [`mapped`] for a ball lens of index n and radius R around (0, c): two
/// refractions by Snell's law, T = (1 - F)^2 with the Fresnel reflectance F averaged over both
/// polarisations, the same at both faces. Light reflected inside the ball leaves it upward, except
/// for a share below F^2. The views lie in the ball's shadow, inside and outside the caustic's fold
/// at 0.076.
#[test]
fn ball_lens() {
    const N: f64 = 1.2;
    const R: f64 = 0.3;
    const C: f64 = 1.2;
    const H: f64 = 2.4;
    const I: f64 = 20.0;
    let refract = |d: glam::DVec2, n: glam::DVec2, eta: f64| {
        let cos_i = -d.dot(n);
        let cos_t = (1.0 - eta * eta * (1.0 - cos_i * cos_i)).sqrt();
        (d * eta + n * (eta * cos_i - cos_t), cos_i, cos_t)
    };
    let map = |theta: f64| -> Option<(f64, f64)> {
        let (o, d) = (glam::DVec2::new(0.0, H), glam::DVec2::new(theta.sin(), -theta.cos()));
        let centre = glam::DVec2::new(0.0, C);
        let b = (o - centre).dot(d);
        let inside = b * b - (o - centre).length_squared() + R * R;
        if inside <= 0.0 {
            return None;
        }
        let p = o + d * (-b - inside.sqrt());
        let (w, cos_i, cos_t) = refract(d, (p - centre) / R, 1.0 / N);
        let q = p - w * (2.0 * (p - centre).dot(w));
        let (v, _, _) = refract(w, -(q - centre) / R, N);
        let s = (cos_i - N * cos_t) / (cos_i + N * cos_t);
        let u = (N * cos_i - cos_t) / (N * cos_i + cos_t);
        let f = 0.5 * (s * s + u * u);
        (v.y < 0.0).then(|| (q.x - v.x * q.y / v.y, (1.0 - f).powi(2)))
    };
    for (place, fov, radius) in [(0.035, 0.5, 0.006), (0.2, 1.0, 0.012)] {
        let camera = Camera {
            position: DVec3::new(place, 0.7, 2.2),
            target: DVec3::new(place, 0.0, 0.0),
            fov,
            size: 8,
        };
        let text = floor(&camera)
            + &format!(
                "[materials.glass]\ntype = \"glass\"\nior = {N:?}\n\
                 [[shapes]]\ntype = \"sphere\"\ncenter = [0, {C}, 0]\nradius = {R}\n\
                 material = \"glass\"\n\
                 [[lights]]\ntype = \"spot\"\nposition = [0, {H}, 0]\ntarget = [0, 0, 0]\n\
                 intensity = {I}\nangle = 20.0\nblend = 0.0\n"
            );
        let truth = camera.floor_picture(radius, |p| ALBEDO / PI * mapped(p.x.hypot(p.z), I, &map));
        for radius_rule in [RadiusRule::Fixed, RadiusRule::Local] {
            let settings =
                RenderSettings { radius_rule, passes: 4, photons: 1 << 14, ..settings(radius) };
            let what = format!("ball lens at {place}, {radius_rule:?}");
            runs_to(0.06, &text, &settings).assert_picture(&what, &truth, 0.06);
        }
    }
}

/// Theory: parallel light that falls into a mirror cylinder of radius R, seen along the axis, is
/// reflected at the wall's point R (cos phi, sin phi) into the direction -(cos 2 phi, sin 2 phi).
/// Its tubes have the width |1 - 2 s / (R cos phi)| after the distance s: they close at the
/// caustic, a nephroid with its cusp at R / 2. Rays descend as far as they travel (45 degrees), so
/// each place receives E_sun / sqrt 2 over the width from every reflected ray through it that
/// entered over the opposite rim and met the wall below its own, and as much from the sun itself
/// where the rim casts no shadow.
#[test]
fn cylinder() {
    const HEIGHT: f64 = 0.8;
    const SUN: f64 = 3.0;
    const STEPS: usize = 2000;
    let mirrored = |phi: f64| {
        let turned = -glam::DVec2::new((2.0 * phi).cos(), (2.0 * phi).sin());
        (glam::DVec2::new(phi.cos(), phi.sin()), turned)
    };
    let at = |k: usize| (2.0 * (k as f64 + 0.37) / STEPS as f64 - 1.0) * 1.2;
    let wall: Vec<_> = (0..STEPS).map(|k| mirrored(at(k))).collect();
    let irradiance = |p: DVec3| {
        let off = |(wall, turned): (glam::DVec2, glam::DVec2)| {
            let to = glam::DVec2::new(p.x, p.z) - wall;
            (to.perp_dot(turned), to.dot(turned))
        };
        // the distance back to the opposite wall along -x
        let direct = p.x + (1.0 - p.z * p.z).sqrt() > HEIGHT;
        let mut widths = f64::from(direct);
        for k in 0..STEPS - 1 {
            let (mut low, mut high) = (at(k), at(k + 1));
            let side = off(wall[k]).0;
            if side * off(wall[k + 1]).0 > 0.0 {
                continue;
            }
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if off(mirrored(middle)).0 * side > 0.0 { low = middle } else { high = middle }
            }
            let s = off(mirrored(low)).1;
            let over_the_rim = s + 2.0 * low.cos() > HEIGHT;
            if s > 0.0 && s < HEIGHT && over_the_rim {
                widths += 1.0 / (1.0 - 2.0 * s / low.cos()).abs();
            }
        }
        SUN * 0.5f64.sqrt() * widths
    };
    // on both sides of the cusp and off the axis; the cusp itself lies between
    for (x, z) in [(0.35, 0.0), (0.65, 0.0), (0.3, 0.35)] {
        let camera = Camera {
            position: DVec3::new(x, 2.5, z + 0.4),
            target: DVec3::new(x, 0.0, z),
            fov: 2.4,
            size: 8,
        };
        let text = floor(&camera)
            + &format!(
                "[materials.mirror]\ntype = \"mirror\"\nreflectance = 1.0\n\
                 [[shapes]]\ntype = \"revolution\"\nprofile = [[1, 0], [1, {HEIGHT}]]\n\
                 material = \"mirror\"\n\
                 [[lights]]\ntype = \"sun\"\ndirection = [1, -1, 0]\nirradiance = {SUN}\n"
            );
        let radius = 0.02;
        let truth = camera.floor_picture(radius, |p| ALBEDO / PI * irradiance(p));
        for direct in DIRECT {
            let settings =
                RenderSettings { direct, passes: 4, photons: 1 << 15, ..settings(radius) };
            let what = format!("cylinder at ({x}, {z}), {direct:?}");
            runs_to(0.12, &text, &settings).assert_picture(&what, &truth, 0.12);
        }
    }
}
