//! The same scene at extreme scales and places.

use caustica::low_level::film::Picture;
use caustica::low_level::scene::settings::{Direct, Radius, RadiusRule, RenderSettings};
use glam::{DVec2, DVec3};

use super::bench::{Bench, folder};
use super::table::{Figure, Row};

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "scaled by powers of two, 2^-20 to 2^20",
            how: "A power of two changes no mantissa, so no bit of a picture. A scene with every shape, material and light is \
                  rendered at each scale (intensities scaled by area, absorption by one over length).",
            unit: "pixels that differ in a bit",
            bound: 0.0,
            measure: |b| {
                let scales = if b.long { &[-20, -13, -1, 6, 20][..] } else { &[-20, 20] };
                let base = picture(b, 1.0, DVec3::ZERO);
                let differ = |e: &i32| differing(&base, &picture(b, 2f64.powi(*e), DVec3::ZERO));
                (scales.iter().map(differ).sum::<usize>() as f64).into()
            },
        },
        Row {
            name: "scaled by 1e-6 to 1e6",
            how: "Other scales change roundings only; paths part where a rounding decides, and equal random numbers keep \
                  the rest equal. Greatest difference of the pictures' means.",
            unit: "relative difference of means",
            bound: 2e-3,
            measure: |b| {
                let scales = if b.long {
                    &[1e-6, 1e-5, 1e-3, 1e-1, 1e2, 1e4, 1e6][..]
                } else {
                    &[1e-6, 1e6]
                };
                compared(b, scales.iter().map(|&scale| (scale, DVec3::ZERO)))
            },
        },
        Row {
            name: "moved by 1e-3 to 1e8 of its size",
            how: "The host moves the scene to its own centre in f64 before anything becomes f32, so that as above only \
                  roundings change (those of f64 at 1e8 sizes are 1e-8 of the size).",
            unit: "relative difference of means",
            bound: 2e-3,
            measure: |b| {
                let shifts =
                    if b.long { &[1e-3, 1e-1, 1e1, 1e3, 1e5, 1e7, 1e8][..] } else { &[1e-3, 1e8] };
                compared(b, shifts.iter().map(|&s| (1.0, DVec3::new(0.9, -0.3, 0.4) * (4.0 * s))))
            },
        },
        Row {
            name: "a convex lit ball, radius 1e-6 to 1e6, up to 1e7 radii from the origin",
            how: "No point of a convex ball that faces the sun is in shadow: with one shadow ray per pixel, each pixel on \
                  the lit side (a pixel's width inside the outline and the terminator) is above 0.",
            unit: "shadowed pixels",
            bound: 0.0,
            measure: |b| {
                let scales = if b.long {
                    &[1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6][..]
                } else {
                    &[1e-6, 1.0, 1e6]
                };
                let places = if b.long { &[0.0, 1.0, 1e3, 1e5, 1e7][..] } else { &[0.0, 1e7] };
                let at = |&scale: &f64| places.iter().map(|&p| shadowed(b, scale, p)).sum::<u32>();
                f64::from(scales.iter().map(at).sum::<u32>()).into()
            },
        },
    ]
}

fn settings(scale: f64) -> RenderSettings {
    RenderSettings {
        direct: Direct::Photons,
        passes: 2,
        photons: 1 << 13,
        radius: Radius::Units(0.05 * scale),
        radius_rule: RadiusRule::Fixed,
        ..RenderSettings::default()
    }
}

fn picture(b: &Bench, scale: f64, shift: DVec3) -> Picture {
    let name = "everything.obj";
    let path = folder().join(name);
    if !path.exists() {
        // tests run in parallel, so the rename publishes a complete file
        let neighbor = path.with_extension(format!("{:?}.part", std::thread::current().id()));
        std::fs::write(&neighbor, crate::everything::MESH).expect("written");
        std::fs::rename(&neighbor, &path).expect("renamed");
    }
    let size = b.samples(32, 64);
    b.render(&crate::everything::everything_with(name, scale, shift, size), &settings(scale))
}

fn differing(a: &Picture, b: &Picture) -> usize {
    a.rgb.iter().zip(&b.rgb).filter(|(a, b)| a.map(f32::to_bits) != b.map(f32::to_bits)).count()
}

fn compared(b: &Bench, changes: impl Iterator<Item = (f64, DVec3)>) -> Figure {
    let sum = |p: &Picture| p.rgb.as_flattened().iter().map(|&x| f64::from(x)).sum::<f64>();
    let base = picture(b, 1.0, DVec3::ZERO);
    let (mut worst, mut touched) = (0.0f64, 0);
    for (scale, shift) in changes {
        let changed = picture(b, scale, shift);
        worst = worst.max((sum(&changed) / sum(&base) - 1.0).abs());
        let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-3 * a.abs();
        let pixels = base.rgb.iter().zip(&changed.rgb);
        touched = touched.max(pixels.filter(|(p, q)| !p.iter().zip(*q).all(near)).count());
    }
    let share = 100.0 * touched as f64 / base.rgb.len() as f64;
    Figure {
        value: worst,
        note: format!("At most {share:.1} % of the pixels differ by more than 1e-3."),
    }
}

/// Number of black pixels on the lit side of a ball.
fn shadowed(b: &Bench, radius: f64, place: f64) -> u32 {
    let n = b.samples(96, 192);
    let at = DVec3::new(0.7, 0.4, -0.2) * place * radius;
    let from = DVec3::new(0.0, 0.0, 4.0) * radius;
    let list = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let text = format!(
        "version = 1\n[camera]\nposition = {}\ntarget = {}\nfov = 20.0\n[film]\nwidth = {n}\n\
         height = {n}\n\
         [materials.m]\ntype = \"diffuse\"\nreflectance = 1.0\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = {}\nradius = {radius:?}\nmaterial = \"m\"\n\
         [[lights]]\ntype = \"sun\"\ndirection = [0.1, 0.05, -1.0]\nirradiance = 1.0\n",
        list(at + from),
        list(at),
        list(at),
    );
    let settings =
        RenderSettings { passes: 1, photons: 1, max_bounces: 0, ..RenderSettings::default() };
    let picture = b.render(&text, &settings);
    let to_sun = -DVec3::new(0.1, 0.05, -1.0).normalize();
    let tan = 10f64.to_radians().tan();
    let mut dark = 0;
    for (i, c) in (0u32..).zip(&picture.rgb) {
        let p =
            DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) * (2.0 / f64::from(n)) - 1.0;
        let d = DVec3::new(p.x * tan, -p.y * tan, -1.0).normalize();
        let o = from / radius;
        let half = o.dot(d);
        let discriminant = half * half - o.length_squared() + 1.0;
        let lit = discriminant > 0.0 && {
            let n = o + d * (-half - discriminant.sqrt());
            n.dot(to_sun) > 0.08 && n.dot(-d) > 0.2
        };
        dark += u32::from(lit && c[0] <= 0.0);
    }
    dark
}
