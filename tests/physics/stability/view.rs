//! Extreme lights, films and cameras.

use caustica::low_level::scene::settings::{Direct, Radius, RadiusRule, RenderSettings};

use super::bench::Bench;
use super::table::{Figure, Row};

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "radiance 1e-30 and 1e30, albedo 0 and 1",
            how: "A plane of reflectance rho under a sun of irradiance E overhead has the radiance rho E / pi in every pixel; a \
                  wall that shines with L has L. At either strength, with albedo 0, 0.5 and 1.",
            unit: "relative error of the worst pixel",
            bound: 1e-6,
            measure: strengths,
        },
        Row {
            name: "images of 1 x 1, 16384 x 1 and 1 x 16384",
            how: "The same plane in films of these sizes, at fields of view that make the long side 60 degrees wide.",
            unit: "relative error of the worst pixel",
            bound: 1e-6,
            measure: sizes,
        },
        Row {
            name: "a lamp of radius 1e-6 and one of 1e6",
            how: "A disc of radius 1e-6 at height 1 gives the floor below the radiance rho L (1e-6)^2; a sphere of radius 1e6 \
                  that almost touches it gives rho L. Monte Carlo means over the picture.",
            unit: "relative error",
            bound: 1e-2,
            measure: lamps,
        },
        Row {
            name: "max_bounces 1 and 1000",
            how: "In a closed room whose walls emit Le and reflect rho, photons stored up to their \
                  b-th bounce give Le (1 - rho^(b+2)) / (1 - rho): 1.75 Le for one at rho 0.5 and 100 Le for 1000 at rho 0.99. \
                  Photons on the middle of a wall.",
            unit: "relative error",
            bound: 4e-2,
            measure: bounces,
        },
        Row {
            name: "field of view 0.01 and 179 degrees",
            how: "A shining wall ends at 0.3 of the half picture. The sum over a row counts its pixels.",
            unit: "error of the edge in pixels",
            bound: 0.1,
            measure: fields,
        },
        Row {
            name: "aperture 0 and large, focus at the near end",
            how: "The same edge out of focus: a pixel's share of light is that of the lens from which the wall is seen, a \
                  segment of the disc, in closed form. Aperture 0; 0.02 focused at 0.05; 10 focused at 0.97; 1e3 focused at \
                  0.9997, with the edge at distance 1. Worst column, over rows and passes.",
            unit: "standard deviations",
            bound: 4.5,
            measure: apertures,
        },
    ]
}

fn film(width: u32, height: u32, fov: f64) -> String {
    format!(
        "version = 1\n[camera]\nposition = [0, 2, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\n\
         fov = {fov:?}\n\
         [film]\nwidth = {width}\nheight = {height}\n"
    )
}

fn plane(rho: f64, strength: f64) -> String {
    format!(
        "[materials.m]\ntype = \"diffuse\"\nreflectance = {rho:?}\n\
         [[shapes]]\ntype = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = \"m\"\n\
         [[lights]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = {strength:?}\n"
    )
}

fn one_pass() -> RenderSettings {
    RenderSettings { passes: 1, photons: 1, max_bounces: 0, ..RenderSettings::default() }
}

/// Largest relative deviation of a pixel from `truth` (absolute where the truth is zero, against
/// one).
fn worst(rgb: &[[f32; 3]], truth: f64) -> f64 {
    let scale = if truth == 0.0 { 1.0 } else { truth };
    let off = |x: &f32| (f64::from(*x) - truth).abs() / scale;
    rgb.as_flattened().iter().map(off).fold(0.0, |a, b| if a >= b { a } else { b })
}

fn strengths(b: &Bench) -> Figure {
    let mut largest = 0.0f64;
    for strength in [1e-30, 1.0, 1e30] {
        for rho in [0.0, 0.5, 1.0] {
            let picture = b.render(&(film(8, 8, 40.0) + &plane(rho, strength)), &one_pass());
            largest = largest.max(worst(&picture.rgb, rho * strength / std::f64::consts::PI));
        }
        let wall = format!(
            "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 9\n\
             material = \"m\"\nemission = {strength:?}\n"
        );
        largest =
            largest.max(worst(&b.render(&(film(8, 8, 40.0) + &wall), &one_pass()).rgb, strength));
    }
    largest.into()
}

fn sizes(b: &Bench) -> Figure {
    let wide = 2.0 * ((0.5f64.to_radians() * 60.0).tan() / 16384.0).atan().to_degrees();
    let truth = 0.5 / std::f64::consts::PI;
    let films = [(1, 1, 40.0), (16384, 1, wide), (1, 16384, 60.0)];
    let off = films.map(|(width, height, fov)| {
        let picture = b.render(&(film(width, height, fov) + &plane(0.5, 1.0)), &one_pass());
        assert_eq!(picture.rgb.len(), (width * height) as usize);
        worst(&picture.rgb, truth)
    });
    off.into_iter().fold(0.0, f64::max).into()
}

fn mean(rgb: &[[f32; 3]]) -> f64 {
    rgb.iter().map(|c| f64::from(c[0])).sum::<f64>() / rgb.len() as f64
}

fn lamps(b: &Bench) -> Figure {
    let lamp = |shape: &str| {
        format!(
            "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[materials.k]\n\
             type = \"diffuse\"\nreflectance = 0.0\n\
             [[shapes]]\ntype = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
             material = \"m\"\n\
             [[shapes]]\n{shape}\nmaterial = \"k\"\nemission = 3.0\n"
        )
    };
    let settings = RenderSettings { passes: b.samples(16, 64), ..one_pass() };
    // a camera next to the lamp's axis, looking at a small part of the floor below it
    let look = "version = 1\n[camera]\nposition = [0.3, 0.4, 0]\ntarget = [0, 0, 0]\nfov = 0.5\n\
                [film]\nwidth = 48\nheight = 48\n";
    let small = lamp("type = \"disc\"\ncenter = [0, 1, 0]\nnormal = [0, -1, 0]\nradius = 1e-6");
    let small =
        mean(&b.render(&(look.to_owned() + &small), &settings).rgb) / (0.5 * 3.0 * 1e-12) - 1.0;
    let large = lamp("type = \"sphere\"\ncenter = [0, 1000001, 0]\nradius = 1e6");
    let sin_sq = (1e6f64 / 1_000_001.0).powi(2);
    let large =
        mean(&b.render(&(look.to_owned() + &large), &settings).rgb) / (0.5 * 3.0 * sin_sq) - 1.0;
    Figure {
        value: small.abs().max(large.abs()),
        note: format!("Small: {small:+.1e}, large: {large:+.1e}."),
    }
}

fn bounces(b: &Bench) -> Figure {
    let mut largest = 0.0f64;
    for (bounces, rho) in [(1u32, 0.5f64), (1000, 0.99)] {
        let mut text = format!(
            "version = 1\n[camera]\nposition = [0, 0, 0.9]\ntarget = [0, 0, -1]\nfov = 20\n\
             [film]\nwidth = 8\nheight = 8\n\
             [materials.m]\ntype = \"diffuse\"\nreflectance = {rho:?}\n"
        );
        for (o, u, v) in [
            ([-1, -1, -1], [0, 0, 2], [2, 0, 0]),
            ([-1, 1, -1], [2, 0, 0], [0, 0, 2]),
            ([-1, -1, -1], [2, 0, 0], [0, 2, 0]),
            ([-1, -1, 1], [0, 2, 0], [2, 0, 0]),
            ([-1, -1, -1], [0, 2, 0], [0, 0, 2]),
            ([1, -1, -1], [0, 0, 2], [0, 2, 0]),
        ] {
            text += &format!(
                "[[shapes]]\ntype = \"rectangle\"\norigin = {o:?}\nu = {u:?}\nv = {v:?}\n\
                 material = \"m\"\nemission = 0.25\n"
            );
        }
        let settings = RenderSettings {
            passes: b.samples(4, 32),
            photons: 1 << 12,
            max_bounces: bounces,
            direct: Direct::Photons,
            radius: Radius::Units(0.3),
            radius_rule: RadiusRule::Fixed,
            ..RenderSettings::default()
        };
        let truth = 0.25 * (1.0 - rho.powi(bounces as i32 + 2)) / (1.0 - rho);
        largest = largest.max((mean(&b.render(&text, &settings).rgb) / truth - 1.0).abs());
    }
    largest.into()
}

const COLUMNS: u32 = 32;
const ROWS: u32 = 32;

/// An image of a wall at distance 1 that emits left of x = `edge`; the view is along -z. The wall
/// extends `reach` to each side.
fn edge_picture(b: &Bench, fov: f64, edge: f64, reach: f64, lens: &str, passes: u32) -> Vec<f64> {
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = {fov:?}\n{lens}\n\
         [film]\nwidth = {COLUMNS}\nheight = {ROWS}\n[materials.m]\ntype = \"diffuse\"\n\
         reflectance = 0.0\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [{:?}, {:?}, 0]\nu = [{reach:?}, 0, 0]\n\
         v = [0, {:?}, 0]\nmaterial = \"m\"\nemission = 1.0\n",
        edge - reach,
        -reach,
        2.0 * reach
    );
    let picture = b.render(&text, &RenderSettings { passes, ..one_pass() });
    let column = |x: u32| {
        (0..ROWS).map(|y| f64::from(picture.rgb[(y * COLUMNS + x) as usize][0])).sum::<f64>()
    };
    (0..COLUMNS).map(|x| column(x) / f64::from(ROWS)).collect()
}

fn fields(b: &Bench) -> Figure {
    let off = [0.01, 179.0].map(|fov: f64| {
        let half = (0.5 * fov).to_radians().tan();
        let seen: f64 =
            edge_picture(b, fov, 0.3 * half, 2.0 * half, "", b.samples(32, 256)).iter().sum();
        (seen - 0.65 * f64::from(COLUMNS)).abs()
    });
    off.into_iter().fold(0.0, f64::max).into()
}

fn apertures(b: &Bench) -> Figure {
    let fov = 30.0f64;
    let tan = (0.5 * fov).to_radians().tan();
    let passes = b.samples(256, 1024);
    let mut worst = 0.0f64;
    for (aperture, focus) in [(0.0, 1.0), (0.02, 0.05), (10.0, 0.97), (1e3, 0.9997)] {
        let lens = format!("aperture = {aperture:?}\nfocus = {focus:?}");
        // a ray from x on the lens through s on the plane at distance one meets the wall at x (1 -
        // 1/focus) + s
        let blur = aperture * (1.0f64 - 1.0 / focus).abs();
        let seen = edge_picture(b, fov, 0.0, 2.0 * (tan + blur), &lens, passes);
        let share = |s: f64| match s / blur {
            q if blur == 0.0 || q.abs() >= 1.0 => f64::from(s < 0.0),
            q => 0.5 - (q * (1.0 - q * q).sqrt() + q.asin()) / std::f64::consts::PI,
        };
        for (x, seen) in (0..COLUMNS).zip(seen) {
            let at = |k: u32| {
                (2.0 * (f64::from(x) + (f64::from(k) + 0.5) / 64.0) / f64::from(COLUMNS) - 1.0)
                    * tan
            };
            let truth = (0..64).map(|k| share(at(k))).sum::<f64>() / 64.0;
            let n = f64::from(ROWS * passes);
            // at least the weight of one sample
            let sigma = (truth * (1.0 - truth) / n).sqrt().max(1.0 / n);
            worst = worst.max((seen - truth).abs() / sigma);
        }
    }
    worst.into()
}
