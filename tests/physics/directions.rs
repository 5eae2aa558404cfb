//! Narrow spots, skies at their seam and poles, and textures on shapes: upright, not mirrored, far
//! from the origin.

use std::f64::consts::PI;

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::{Surface, surface_at};
use caustica::low_level::lights::environment::eval_environment;
use caustica::low_level::materials::shading::reflectance_at;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RenderSettings};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::tables::SceneTables;
use glam::{DVec3, Vec3};

use super::lab::*;

fn grey_file(
    name: &str,
    width: usize,
    height: usize,
    value: impl Fn(usize, usize) -> f32 + Sync,
) -> String {
    let at = |x, y| (value(x, y), value(x, y), value(x, y));
    exr::prelude::write_rgb_file(folder().join(name), width, height, at).unwrap();
    name.to_owned()
}

/// Theory: within its full cone a spot gives the radiance `rho I / (pi d^2)` to a surface that
/// faces it, however narrow the cone is: by shadow rays, by photons and by path tracing.
#[test]
fn narrow_spots() {
    for degrees in [0.001f64, 0.01, 0.02, 0.3, 1.0] {
        for blend in [0.0, 0.5] {
            let full = (degrees * (1.0 - blend)).to_radians();
            // the middle half of the area that the full cone lights
            let fov = 2.0 * full.tan().atan().to_degrees();
            let camera = format!(
                "position = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\nfov = {fov:?}\n"
            );
            let text = format!(
                "version = 1\n[camera]\n{camera}[film]\nwidth = 8\nheight = 8\n\
                 [materials.d]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                 [[shapes]]\ntype = \"rectangle\"\norigin = [-5, 0, 5]\nu = [10, 0, 0]\n\
                 v = [0, 0, -10]\n\
                 material = \"d\"\n[[lights]]\ntype = \"spot\"\nposition = [0, 10, 0]\n\
                 target = [0, 0, 0]\n\
                 intensity = 400.0\nangle = {degrees}\nblend = {blend}\n"
            );
            let truth = 0.5 / PI * 400.0 / 100.0;
            let radius = Radius::Units(10.0 * full.tan() / 8.0);
            for direct in DIRECT {
                let settings = RenderSettings { direct, radius, photons: 1 << 14, ..settings(1.0) };
                let found = runs(&text, &settings).region(|_, _| true);
                assert_agrees(
                    &format!("{degrees} degrees, blend {blend}, {direct:?}"),
                    found,
                    truth,
                    0.05,
                );
            }
            let path = RenderSettings { method: Method::Path, ..settings(1.0) };
            let found = runs(&text, &path).region(|_, _| true);
            assert_agrees(&format!("{degrees} degrees, blend {blend}, path"), found, truth, 0.01);
        }
    }
}

/// Theory: an image of 4096 rows has light L in the top row only. The bilinear filter turns it into
/// L up to half a row from the pole and a slope to 0 at one row and a half. With a row's angle `a =
/// pi / 4096`, a floor receives `E = 2 pi a^2 L (1/8 + 5/12)`.
#[test]
fn light_at_the_pole() {
    let sky = grey_file("physics-pole.exr", 2, 4096, |_, y| if y == 0 { 1e6 } else { 0.0 });
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 5, 0.01]\ntarget = [0, 0, 0]\nfov = 20.0\n\
         [film]\nwidth = 8\nheight = 8\n[materials.d]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-5, 0, 5]\nu = [10, 0, 0]\nv = [0, 0, -10]\n\
         material = \"d\"\n[environment]\nfile = \"{sky}\"\nrotate = 30.0\n"
    );
    let angle = PI / 4096.0;
    let truth = 0.5 / PI * 2.0 * PI * angle * angle * 1e6 * (0.125 + 5.0 / 12.0);
    for direct in DIRECT {
        let settings = RenderSettings { direct, photons: 1 << 14, passes: 16, ..settings(0.2) };
        let found = runs(&text, &settings).region(|_, _| true);
        assert_agrees(&format!("{direct:?}"), found, truth, 0.03);
    }
    let path = RenderSettings { method: Method::Path, passes: 64, ..settings(1.0) };
    assert_agrees("path", runs(&text, &path).region(|_, _| true), truth, 0.03);
}

fn packed(text: &str) -> PackedScene {
    let head = "version = 1\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 40.0\n";
    prepare(&parse(&format!("{head}{text}")), 8, 8).unwrap()
}

/// Theory: a sky is periodic: at the image's left and right edge it is the mean of the columns on
/// either side, as between any two columns.
#[test]
fn a_sky_has_no_seam() {
    let sky = grey_file("physics-seam.exr", 8, 4, |x, _| if x == 0 { 3.0 } else { x as f32 });
    let scene = packed(&format!("[environment]\nfile = \"{sky}\"\n")).tables;
    let at = |u: f64| {
        let (sin, cos) = ((0.5 - u) * 2.0 * PI).sin_cos();
        eval_environment(&scene, &scene.lights[0], Vec3::new(cos as f32, 0.0, sin as f32)).x
    };
    for (u, radiance) in [(1e-4, 5.0), (0.9999, 5.0), (0.0625, 3.0), (0.9375, 7.0), (0.125, 2.0)] {
        assert!((at(u) - radiance).abs() < 0.01, "{u}: {} and {radiance}", at(u));
    }
}

fn hit(scene: &SceneTables, from: DVec3, direction: DVec3) -> Surface {
    let ray =
        Ray { origin: from.as_vec3(), t_min: 0.0, direction: direction.as_vec3(), t_max: 1e30 };
    surface_at(scene, &ray, &intersect_scene(scene, &ray))
}

/// Theory: for a viewer outside who looks at a face along its normal n with `up` upward, `up x n`
/// points right. On all six faces u increases to the right and v upward. On top up is -z, on the
/// bottom z.
#[test]
fn pictures_on_boxes_are_not_mirrored() {
    let packed = packed(
        "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nmaterial = \"m\"\n",
    );
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for normal in [axis, -axis] {
            let up = if axis == DVec3::Y { -normal.y * DVec3::Z } else { DVec3::Y };
            let right = up.cross(normal);
            for (a, b) in [(0.3, 0.2), (-0.6, 0.7), (0.1, -0.9)] {
                let from = (normal * 3.0 + right * a + up * b - packed.center) / packed.unit;
                let s = hit(&packed.tables, from, -normal);
                let expected = [0.5 + 0.5 * a, 0.5 + 0.5 * b];
                let off = (f64::from(s.uv.x) - expected[0]).abs()
                    + (f64::from(s.uv.y) - expected[1]).abs();
                assert!(off < 1e-5, "{normal}: {:?} and {expected:?}", s.uv);
            }
        }
    }
}

/// Theory: an image whose rows are white at the top and black at the bottom is white at a sphere's
/// north pole and black at its south pole although it repeats, and so are the ends of a vase. On a
/// ring the image is periodic.
#[test]
fn poles_do_not_mix() {
    let picture = grey_file("physics-rows.exr", 4, 4, |_, y| [1.0, 0.6, 0.3, 0.0][y]);
    let material = format!(
        "[textures.t]\ntype = \"image\"\nfile = \"{picture}\"\n\
         [materials.m]\ntype = \"diffuse\"\nreflectance = \"t\"\n"
    );
    let reflectance = |shape: &str, from: DVec3, direction: DVec3| {
        let text = format!("{material}[[shapes]]\n{shape}\nmaterial = \"m\"\n");
        let head = "version = 1\n[camera]\nposition = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 40.0\n";
        let packed = prepare(&parse(&format!("{head}{text}")), 8, 8).unwrap();
        let s = hit(&packed.tables, (from - packed.center) / packed.unit, direction);
        reflectance_at(&packed.tables, s.material, s.uv).x
    };
    let sphere = "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1";
    let near = DVec3::new(1e-3, 3.0, 2e-3);
    assert_eq!(reflectance(sphere, near, DVec3::NEG_Y), 1.0);
    assert_eq!(reflectance(sphere, DVec3::new(1e-3, -3.0, 2e-3), DVec3::Y), 0.0);
    let vase = "type = \"revolution\"\nprofile = [[1, 0], [1, 1]]";
    assert_eq!(reflectance(vase, DVec3::new(3.0, 0.999, 1e-3), DVec3::NEG_X), 1.0);
    assert_eq!(reflectance(vase, DVec3::new(3.0, 0.001, 1e-3), DVec3::NEG_X), 0.0);
    let ring =
        "type = \"revolution\"\nsegments = [[[1, 0], [2, 0], [2, 1]], [[2, 1], [1, 1], [1, 0]]]";
    let seam = reflectance(ring, DVec3::new(1.0005, -3.0, 1e-3), DVec3::Y);
    assert!((seam - 0.5).abs() < 0.1, "{seam}");
}

/// Theory: a checker, a repeated image and planks look the same after a whole number of periods, as
/// far as the file's numbers are precise.
#[test]
fn textures_far_from_the_origin() {
    let picture = grey_file("physics-far.exr", 4, 4, |x, y| ((x + 2 * y) % 4) as f32 / 4.0);
    let textures = [
        "type = \"checker\"\ncolors = [0.9, 0.1]\nscale = [4.0, 4.0]".to_owned(),
        format!("type = \"image\"\nfile = \"{picture}\"\nfilter = \"nearest\"\nscale = [2.0, 2.0]"),
        format!("type = \"planks\"\nfile = \"{picture}\"\nsize = [0.5, 2.0]\nfilter = \"nearest\""),
    ];
    let mesh = file("physics-far.obj", b"v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4\n");
    let shapes = |x: f64| {
        let corner = x - 2.0;
        [
            format!(
                "type = \"rectangle\"\norigin = [{corner:?}, 0, {:?}]\nu = [4, 0, 0]\n\
                 v = [0, 0, -4]\nuv = \"planar\"",
                x + 2.0
            ),
            "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nuv = \"planar\"".to_owned(),
            format!(
                "type = \"mesh\"\nfile = \"{mesh}\"\nuv = \"planar\"\n\
                 transform = {{ translate = [{x:?}, 0, {x:?}] }}"
            ),
            "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]".to_owned(),
        ]
    };
    let render_at = |texture: &str, shape: &str, x: f64| {
        let text = format!(
            "version = 1\n[camera]\nposition = [{x:?}, 1.5, {:?}]\ntarget = [{x:?}, 0, {x:?}]\n\
             fov = 40.0\n\
             [film]\nwidth = 32\nheight = 24\n[textures.t]\n{texture}\n\
             [materials.m]\ntype = \"diffuse\"\nreflectance = \"t\"\n[[shapes]]\n{shape}\n\
             material = \"m\"\n\
             [environment]\nradiance = 1.0\n",
            x + 1.5
        );
        grey(&render(
            &parse(&text),
            &RenderSettings { method: Method::Path, passes: 1, ..settings(1.0) },
        ))
    };
    for texture in &textures {
        for (near, far) in shapes(0.0).iter().zip(shapes(1e7)) {
            let (near, far) = (render_at(texture, near, 0.0), render_at(texture, &far, 1e7));
            let differ = near.iter().zip(&far).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
            assert!(
                differ < near.len() / 20,
                "{differ} of {} pixels: {texture}\n{far:?}",
                near.len()
            );
            assert!(near.iter().any(|x| (x - near[0]).abs() > 0.2), "a single colour: {texture}");
        }
    }
}

/// Theory: shadow rays and photons give the same result for a sky with its light at the seam.
#[test]
fn a_lamp_across_the_seam() {
    let sky = grey_file("physics-lamp.exr", 64, 32, |x, y| {
        if (x == 0 || x == 63) && y == 8 { 500.0 } else { 0.1 }
    });
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 5, 0.01]\ntarget = [0, 0, 0]\nfov = 20.0\n\
         [film]\nwidth = 8\nheight = 8\n[materials.d]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-5, 0, 5]\nu = [10, 0, 0]\nv = [0, 0, -10]\n\
         material = \"d\"\n[environment]\nfile = \"{sky}\"\n"
    );
    let by = |direct: Direct| {
        let settings = RenderSettings { direct, photons: 1 << 15, passes: 8, ..settings(0.2) };
        runs(&text, &settings).region(|_, _| true)
    };
    let path = RenderSettings { method: Method::Path, passes: 64, ..settings(1.0) };
    let path = runs(&text, &path).region(|_, _| true);
    assert_same("shadow rays and photons", by(Direct::Sampled), by(Direct::Photons), 0.08);
    assert_same("shadow rays and paths", by(Direct::Sampled), path, 0.08);
}

/// Theory: a sky of radiance 1 over half of the directions lights a floor that faces that half with
/// `rho pi / pi`. A sun 10^4 times as strong in the other half does not light it. Rows and texels
/// of the dim half are drawn rarely, but they are drawn.
#[test]
fn a_dim_sky_beside_a_bright_sun() {
    let (width, height) = (64, 1024);
    let sun = 4e9;
    let sky = grey_file("physics-dim.exr", width, height, |x, y| match y {
        1000 if x == 5 => sun,
        y if y < 512 => 1.0,
        _ => 0.0,
    });
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 5, 0.01]\ntarget = [0, 0, 0]\nfov = 20.0\n\
         [film]\nwidth = 8\nheight = 8\n[materials.d]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-5, 0, 5]\nu = [10, 0, 0]\nv = [0, 0, -10]\n\
         material = \"d\"\n[environment]\nfile = \"{sky}\"\n"
    );
    let path = RenderSettings { method: Method::Path, passes: 64, ..settings(1.0) };
    assert_agrees("path", runs(&text, &path).region(|_, _| true), 0.5, 0.05);
    let scene = prepare(&parse(&text), 8, 8).unwrap().tables;
    let light = &scene.lights[0];
    let bins = |first: u32, count: u32| {
        let at = |i: u32| f64::from(scene.distributions[(light.first + first + i) as usize]);
        (0..count).map(move |i| at(i) - if i > 0 { at(i - 1) } else { 0.0 }).collect::<Vec<_>>()
    };
    let rows = bins(0, height as u32);
    assert!(rows[..512].iter().all(|share| *share >= 2f64.powi(-24)), "a dim row is never drawn");
    // the filter spreads it over its neighbours
    assert!(rows[999..1002].iter().sum::<f64>() > 0.9, "the sun is not the strongest");
}
