//! Projections: directions, footprints, and light through each camera.

use std::f64::consts::{PI, TAU};

use caustica::low_level::camera::{camera_ray, footprint};
use caustica::low_level::math::FAR;
use caustica::low_level::pack::{PackedScene, pack};
use caustica::low_level::prepare::normalize::Normalization;
use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::tables::{ASTRIDE, NONE};
use glam::{DVec3, Vec3, Vec4};

use super::agreement::pairwise;
use super::lab::*;

/// The rest of a scene: a matte floor, a ball and a lamp.
const ROOM: &str = "[render]\nphotons = 1000\n[materials.m]\ntype = \"diffuse\"\n\
                    reflectance = 0.5\n\
    [[shapes]]\ntype = \"rectangle\"\norigin = [-2, 0, 2]\nu = [4, 0, 0]\nv = [0, 0, -4]\n\
    material = \"m\"\n\
    [[shapes]]\ntype = \"sphere\"\ncenter = [0.5, 0.4, 0]\nradius = 0.4\nmaterial = \"m\"\n\
    [[shapes]]\ntype = \"rectangle\"\norigin = [-1, 2, -1]\nu = [2, 0, 0]\nv = [0, 0, 2]\n\
    material = \"m\"\n\
    emission = 2.0\n";

/// A scene seen along a slanted axis.
fn text(camera: &str, (width, height): (u32, u32), rest: &str) -> String {
    format!(
        "version = 1\n[camera]\nposition = [0.3, 1.2, 1.6]\ntarget = [0.1, 0.4, 0.2]\n\
         up = [0.1, 1, 0]\n\
         {camera}\n[film]\nwidth = {width}\nheight = {height}\n{rest}"
    )
}

fn packed(camera: &str, size: (u32, u32)) -> PackedScene {
    let scene = parse(&text(camera, size, ROOM));
    pack(&scene, Normalization::of(&scene), size.0, size.1).unwrap()
}

/// Right, up and forward of the camera of [`text`].
fn axes() -> [DVec3; 3] {
    let forward = (DVec3::new(0.1, 0.4, 0.2) - DVec3::new(0.3, 1.2, 1.6)).normalize();
    let right = forward.cross(DVec3::new(0.1, 1.0, 0.0)).normalize();
    [right, right.cross(forward), forward]
}

/// The ray through a point of the image, in pixels from its upper left corner.
fn ray(packed: &PackedScene, x: f64, y: f64) -> Ray {
    let u = Vec4::new(x.fract() as f32, y.fract() as f32, 0.0, 0.0);
    camera_ray(&packed.tables.camera, x as u32, y as u32, u)
}

fn double(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

const SIZE: (u32, u32) = (64, 36);

/// Points over the whole image, in pixels.
fn points() -> impl Iterator<Item = (f64, f64)> {
    (0..9).flat_map(|i| (0..7).map(move |j| (0.3 + 7.9 * f64::from(i), 0.7 + 5.8 * f64::from(j))))
}

/// Checks the origin in the world, relative to the position, and the direction of each ray.
/// `expected` maps image coordinates in [-1, 1], upward, to both; `None` where nothing is seen.
fn follows(camera: &str, expected: impl Fn(f64, f64) -> Option<(DVec3, DVec3)>) -> f64 {
    let packed = packed(camera, SIZE);
    let mut worst = 0.0f64;
    for (x, y) in points() {
        let found = ray(&packed, x, y);
        let (px, py) = (2.0 * x / f64::from(SIZE.0) - 1.0, 1.0 - 2.0 * y / f64::from(SIZE.1));
        let Some((origin, direction)) = expected(px, py) else {
            worst = worst.max(f64::from(found.t_max));
            continue;
        };
        assert_eq!(found.t_max, FAR, "{camera}: {px} {py}");
        let from = double(found.origin) * packed.unit + packed.center - DVec3::new(0.3, 1.2, 1.6);
        worst = worst.max((from - origin).length());
        worst = worst.max((double(found.direction) - direction.normalize()).length());
    }
    worst
}

/// Theory: each projection maps image coordinates (x, y) in [-1, 1] to a ray in closed form. With
/// half the height h = tan(fov / 2) and the aspect a, a perspective camera looks along
/// f + x a h r + y h u. A field of view along another axis stretches the image, a shift adds twice
/// its share of the window. An orthographic ray starts there, a panorama's direction has the
/// longitude pi x and the latitude pi y / 2, a fisheye's the distance from the centre as angle.
#[test]
fn projections_follow_their_maps() {
    let [r, u, f] = axes();
    let aspect = 64.0 / 36.0;
    let plane =
        |h: f64, x: f64, y: f64| Some((DVec3::ZERO, f + r * (x * h * aspect) + u * (y * h)));
    let tan = |degrees: f64| (0.5 * degrees).to_radians().tan();
    let diagonal = (aspect * aspect + 1.0).sqrt();
    for (camera, h) in [
        ("fov = 40", tan(40.0)),
        ("type = \"perspective\"\nfov = 40\nfov_axis = \"vertical\"", tan(40.0)),
        ("fov = 60\nfov_axis = \"horizontal\"", tan(60.0) / aspect),
        ("fov = 60\nfov_axis = \"larger\"", tan(60.0) / aspect),
        ("fov = 60\nfov_axis = \"smaller\"", tan(60.0)),
        ("fov = 60\nfov_axis = \"diagonal\"", tan(60.0) / diagonal),
        ("focal_length = 50", 12.0 / 50.0),
        ("focal_length = 50\nfov_axis = \"horizontal\"", 18.0 / 50.0 / aspect),
        ("focal_length = 8\nsensor = 6", 3.0 / 8.0),
    ] {
        let off = follows(camera, |x, y| plane(h, x, y));
        assert!(off < 1e-6, "{camera}: {off}");
    }
    let shifted =
        follows("fov = 40\nshift = [0.25, -0.5]", |x, y| plane(tan(40.0), x + 0.5, y - 1.0));
    assert!(shifted < 1e-6, "{shifted}");
    let parallel = |x: f64, y: f64| Some((r * (x * 1.5 * aspect) + u * (y * 1.5), f));
    let off = follows("type = \"orthographic\"\nsize = 3", parallel);
    let moved = follows("type = \"orthographic\"\nsize = 3\nshift = [0.25, -0.5]", |x, y| {
        parallel(x + 0.5, y - 1.0)
    });
    assert!(off < 1e-6 && moved < 1e-6, "{off} {moved}");
    let panorama = |x: f64, y: f64| {
        let ((sx, cx), (sy, cy)) = ((PI * x).sin_cos(), (0.5 * PI * y).sin_cos());
        Some((DVec3::ZERO, f * (cx * cy) + r * (sx * cy) + u * sy))
    };
    let off = follows("type = \"panorama\"", panorama);
    assert!(off < 1e-6, "{off}");
    let fisheye = |degrees: f64, h: f64| {
        move |x: f64, y: f64| {
            let (across, along) = (x * h * aspect, y * h);
            let angle = across.hypot(along);
            let (sin, cos) = angle.sin_cos();
            let seen = angle <= (0.5 * degrees).to_radians();
            seen.then(|| (DVec3::ZERO, f * cos + (r * across + u * along) * (sin / angle)))
        }
    };
    for (camera, degrees, share) in [
        ("type = \"fisheye\"\nfov = 180", 180.0, 1.0),
        ("type = \"fisheye\"\nfov = 360", 360.0, 1.0),
        ("type = \"fisheye\"\nfov = 220\nfov_axis = \"diagonal\"", 220.0, 1.0 / diagonal),
    ] {
        let off = follows(camera, fisheye(degrees, 0.5 * f64::to_radians(degrees) * share));
        assert!(off < 1e-6, "{camera}: {off}");
    }
    // a wrong map is noticed
    assert!(follows("fov = 40", |x, y| plane(tan(40.01), x, y)) > 1e-5);
    assert!(follows("type = \"panorama\"", |x, y| panorama(x, -y)) > 0.1);
}

/// Theory: the footprint is the distance between the points that rays half a pixel above and below
/// reach at the same depth: at the centre for a perspective camera, everywhere for an orthographic
/// one and a panorama, and along the radius for a fisheye.
#[test]
fn footprints_are_finite_differences() {
    for (camera, along) in [
        ("fov = 40", false),
        ("fov = 60\nfov_axis = \"diagonal\"", false),
        ("type = \"orthographic\"\nsize = 3\nfov_axis = \"horizontal\"", true),
        ("type = \"panorama\"", true),
        ("type = \"fisheye\"\nfov = 150", true),
    ] {
        let packed = packed(camera, (320, 180));
        for row in [90.0, if along { 30.0 } else { 90.0 }] {
            let [above, below] = [-0.5, 0.5].map(|d| ray(&packed, 160.0, row + d));
            let length = 0.7f32;
            let [a, b] = [&above, &below].map(|ray| ray.origin + ray.direction * length);
            let ratio = (a - b).length() / footprint(&packed.tables.camera, length);
            assert!((ratio - 1.0).abs() < 1e-3, "{camera}, row {row}: {ratio}");
        }
    }
}

/// Radiance of the image by path tracing in this many passes.
fn path_traced(text: &str, passes: u32) -> Vec<f64> {
    let settings = RenderSettings { method: Method::Path, passes, ..settings(0.1) };
    grey(&render(&parse(text), &settings))
}

/// Theory: the integral of radiance over all directions is a sum over pixels weighted by their
/// solid angles: cos(latitude) for a panorama, sin(angle) / angle for a fisheye, which is black
/// beyond its circle. Around the camera it is 4 pi times a constant environment, and for a sphere
/// of radius 0.5 at the distance d it is its radiance times 2 pi (1 - sqrt(1 - (0.5 / d)^2)).
#[test]
fn images_of_all_directions_integrate_to_closed_forms() {
    let ball = "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n[[shapes]]\n\
                type = \"sphere\"\n\
                radius = 0.5\nmaterial = \"m\"\nemission = 1.0\ncenter = ";
    let behind = format!("{ball}[0.5, 2.0, 3.0]\n");
    let side = format!("{ball}[0.3, 1.2, 2.6]\n");
    let sky = "[environment]\nradiance = 1.0\n".to_owned();
    let offset = DVec3::new(0.2, 0.8, 1.4).length();
    let solid = |distance: f64| TAU * (1.0 - (1.0 - 0.25 / (distance * distance)).sqrt());
    let (columns, rows) = (192u32, 96u32);
    let panorama: fn(f64, f64) -> f64 = |_, y| (0.5 * PI * y).cos() * (0.5 * PI) * PI;
    let fisheye: fn(f64, f64) -> f64 = |x, y| {
        let angle = PI * x.hypot(y);
        if angle > PI { 0.0 } else { angle.sin() / angle * PI * PI }
    };
    for (camera, size, weight) in [
        ("type = \"panorama\"", (columns, rows), panorama),
        ("type = \"fisheye\"\nfov = 360", (rows, rows), fisheye),
    ] {
        for (rest, truth) in [(&sky, 2.0 * TAU), (&side, solid(1.0)), (&behind, solid(offset))] {
            let picture = path_traced(&text(camera, size, rest), 16);
            let sum: f64 = (0..size.1)
                .flat_map(|row| (0..size.0).map(move |column| (row, column)))
                .map(|(row, column)| {
                    let x = 2.0 * (f64::from(column) + 0.5) / f64::from(size.0) - 1.0;
                    let y = 1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(size.1);
                    picture[(row * size.0 + column) as usize] * weight(x, y)
                })
                .sum();
            let found = sum * 4.0 / f64::from(size.0 * size.1);
            println!("{camera}: {found} {truth}");
            assert!((found / truth - 1.0).abs() < 0.02, "{camera}, {rest}: {found}, {truth}");
        }
        let picture = path_traced(&text(camera, size, &sky), 4);
        let black = picture.iter().filter(|radiance| **radiance == 0.0).count();
        // a circle leaves 1 - pi/4 of the square
        let corners = if size.0 == size.1 { 0.2 } else { 0.0 };
        let share = black as f64 / picture.len() as f64;
        assert!((share - corners).abs() < 0.02, "{camera}: {share}");
    }
}

/// Theory: a parallel ray from x on the image, through s on its lens, meets a wall at distance D at
/// x + s (1 - D / focus). So the share of light next to an edge is that of a segment of the disc.
#[test]
fn orthographic_lenses_blur_by_distance() {
    const COLUMNS: u32 = 32;
    let passes = 256;
    for (aperture, focus) in [(0.0f64, 1.0f64), (0.3, 0.5), (0.5, 2.0), (0.5, 1.0)] {
        let text = format!(
            "version = 1\n[camera]\ntype = \"orthographic\"\nposition = [0, 0, 1]\n\
             target = [0, 0, 0]\nsize = 2\n\
             aperture = {aperture:?}\nfocus = {focus:?}\n[film]\nwidth = {COLUMNS}\n\
             height = {COLUMNS}\n\
             [materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n[[shapes]]\n\
             type = \"rectangle\"\n\
             origin = [-4, -4, 0]\nu = [4, 0, 0]\nv = [0, 8, 0]\nmaterial = \"m\"\nemission = 1.0\n"
        );
        let blur = aperture * (1.0 - 1.0 / focus).abs();
        let picture = path_traced(&text, passes);
        let share = |s: f64| match s / blur {
            q if blur == 0.0 || q.abs() >= 1.0 => f64::from(s < 0.0),
            q => 0.5 - (q * (1.0 - q * q).sqrt() + q.asin()) / PI,
        };
        for column in 0..COLUMNS {
            let column_mean =
                (0..COLUMNS).map(|row| picture[(row * COLUMNS + column) as usize]).sum::<f64>()
                    / f64::from(COLUMNS);
            let at = |k: u32| {
                2.0 * (f64::from(column) + (f64::from(k) + 0.5) / 64.0) / f64::from(COLUMNS) - 1.0
            };
            let truth = (0..64).map(|k| share(at(k))).sum::<f64>() / 64.0;
            let n = f64::from(COLUMNS * passes);
            let sigma = (truth * (1.0 - truth) / n).sqrt().max(1.0 / n);
            let off = (column_mean - truth).abs() / sigma;
            assert!(off < 4.5, "aperture {aperture}, focus {focus}, column {column}: {off} sigma");
        }
    }
}

/// Theory: path tracing and photon mapping estimate the same image through every camera and pixel
/// filter, with fresh and with fixed visible points. The gather discs are a small part of the
/// image.
#[test]
fn methods_agree_through_every_camera() {
    let cases = [
        (Method::Path, Direct::Sampled, RadiusRule::Fixed),
        (Method::Sppm, Direct::Photons, RadiusRule::Global),
        (Method::Ppm, Direct::Sampled, RadiusRule::Fixed),
    ];
    for (camera, filter) in [
        (
            "type = \"orthographic\"\nsize = 2\naperture = 0.05\nfocus = 1.5",
            "filter = \"mitchell\"",
        ),
        ("type = \"panorama\"", "filter = \"tent\""),
        ("type = \"fisheye\"\nfov = 170\nfov_axis = \"larger\"", "filter = \"gaussian\""),
        ("fov = 50\nshift = [0.1, -0.1]", "filter = \"mitchell\""),
    ] {
        let rest = format!("{filter}\n{ROOM}[environment]\nradiance = 0.3\n");
        pairwise(camera, &text(camera, (16, 16), &rest), &cases, 0.06);
    }
}

/// Theory: rays of an orthographic camera start all over its image. If a glass surface crosses that
/// window, each ray has its own medium; otherwise all share the medium of the centre.
#[test]
fn orthographic_windows_in_glass() {
    let medium = |size: f64| {
        let rest = format!(
            "{ROOM}[materials.g]\ntype = \"glass\"\nior = 1.5\n[[shapes]]\ntype = \"sphere\"\n\
             center = [0.3, 1.2, 1.6]\nradius = 0.2\nmaterial = \"g\"\n"
        );
        let camera = format!("type = \"orthographic\"\nsize = {size:?}");
        let scene = parse(&text(&camera, (16, 16), &rest));
        pack(&scene, Normalization::of(&scene), 16, 16).unwrap().tables.camera.medium
    };
    assert_eq!(medium(1.0), ASTRIDE);
    let inside = medium(0.02);
    assert!(inside != ASTRIDE && inside != NONE, "{inside}");
}
