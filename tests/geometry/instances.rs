//! Instances: rays against closed forms and against the same shapes written out.

use crate::support::{HEAD, data, sound};
use caustica::low_level::geometry::intersect::{intersect_scene, occluded};
use caustica::low_level::geometry::surface::{Surface, surface_at};
use caustica::low_level::math::{FAR, offset_origin};
use caustica::low_level::pack::{PackedScene, pack};
use caustica::low_level::prepare::normalize::Normalization;
use caustica::low_level::scene::{Group, Scene, Shape, ShapeKind, parse};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::tables::{KIND_INSTANCE, NONE, SceneTables, kind_of};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use std::sync::Arc;

const MATERIAL: &str = "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n";

fn scene_of(rest: &str) -> Scene {
    sound(parse(&data("scene.toml"), format!("{HEAD}{MATERIAL}{rest}").as_bytes())).scene
}

/// Packs the shapes alone, with the scene's centre and unit at the origin and one.
fn packed(scene: &Scene) -> PackedScene {
    let n = Normalization { center: DVec3::ZERO, unit: 1.0, radius: 1.0 };
    pack(scene, n, 16, 16).unwrap()
}

fn of_shapes(shapes: Vec<Shape>) -> PackedScene {
    let mut scene = scene_of("");
    scene.shapes = shapes;
    packed(&scene)
}

fn instance(shapes: Vec<Shape>, map: DAffine3) -> Shape {
    Shape::new(ShapeKind::Instance { group: Arc::new(Group::new(shapes)), map }, 0)
}

fn ball() -> Shape {
    Shape::new(ShapeKind::Sphere { center: DVec3::ZERO, radius: 1.0 }, 0)
}

/// Numbers in [0, 1) from an additive sequence with irrational steps.
struct Numbers(f64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = (self.0 * 16807.0 + 0.618_033_988_749_895).fract();
        self.0
    }

    fn signed(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn unit(&mut self) -> DVec3 {
        loop {
            let v = self.signed();
            if v.length() < 1.0 && v.length() > 0.1 {
                return v.normalize();
            }
        }
    }

    fn rotation(&mut self) -> DMat3 {
        DMat3::from_quat(DQuat::from_axis_angle(self.unit(), 6.3 * self.next()))
    }

    /// A map with any orientation, side and ratio of scales up to `most`.
    fn map(&mut self, most: f64) -> DAffine3 {
        let scale = |x: f64| most.powf(x - 0.5);
        let factors = DVec3::new(scale(self.next()), scale(self.next()), scale(self.next()));
        let mirror = if self.next() < 0.5 { -1.0 } else { 1.0 };
        let linear = self.rotation() * DMat3::from_diagonal(factors * mirror) * self.rotation();
        DAffine3::from_mat3_translation(linear, self.signed())
    }
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    let direction = direction.as_vec3().normalize();
    Ray { origin: origin.as_vec3(), t_min: 0.0, direction, t_max: FAR }
}

fn hit_of(scene: &SceneTables, ray: &Ray) -> Option<(f32, Surface)> {
    let hit = intersect_scene(scene, ray);
    (hit.reference != NONE).then(|| (hit.t, surface_at(scene, ray, &hit)))
}

/// Theory: a ray meets the image of the unit sphere under p = A q + b where the ray
/// A^-1 (o - b) + t A^-1 d meets the unit sphere. The hit lies on the ellipsoid within its error
/// bound along the normal, which is A^-T q normalized, on the outer side whether A mirrors or not;
/// and a ray that leaves the hit outward meets nothing, since an ellipsoid is convex. This holds
/// for any A: also for needles and pancakes of ratio 1e4, and for rays from afar.
#[test]
fn ellipsoids_in_closed_form() {
    let mut numbers = Numbers(0.37);
    let (mut met, mut missed, mut worst) = (0, 0, 0.0f64);
    for k in 0..300 {
        let map = numbers.map([2.0, 1e2, 1e4][k % 3]);
        let inverse = map.matrix3.inverse();
        let scene = of_shapes(vec![instance(vec![ball()], map)]).tables;
        for _ in 0..100 {
            // towards a point of the ellipsoid, at most near its silhouette
            let aim = map.transform_point3(numbers.unit() * 1.3 * numbers.next().sqrt());
            let far = [3.0, 300.0][k % 2] * (1.0 + numbers.next());
            let origin = aim + numbers.unit() * far * map.matrix3.x_axis.length().max(1.0);
            let ray = ray(origin, aim - origin);
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let (p, e) = (inverse * (o - map.translation), inverse * d);
            let (a, b, c) = (e.dot(e), p.dot(e), p.cross(e).length_squared());
            let inside = 1.0 - c / a;
            // rounding decides the silhouette; origins are outside
            if inside.abs() < 2e-2 || p.length() < 1.1 {
                continue;
            }
            let Some((t, s)) = hit_of(&scene, &ray) else {
                assert!(inside < 0.0, "{k}: a ray passes through the ellipsoid, {inside}");
                missed += 1;
                continue;
            };
            assert!(inside > 0.0, "{k}: a ray that passes the ellipsoid meets it, {inside}");
            met += 1;
            let exact = -(b + (b * b - a * (p.dot(p) - 1.0)).max(0.0).sqrt()) / a;
            let exact = if p.length() > 1e3 { -(b / a) - (inside / a).sqrt() } else { exact };
            let size = map.matrix3.x_axis.length() + map.matrix3.y_axis.length() + 3.0;
            let size = size + map.matrix3.z_axis.length();
            assert!((f64::from(t) - exact).abs() < 2e-5 * (size + exact), "{k}: {t} {exact}");
            // first-order distance from the ellipsoid, along its normal
            let q = inverse * (s.position.as_dvec3() - map.translation);
            let gradient = inverse.transpose() * q;
            let off = (q.length() - 1.0) / gradient.length();
            worst = worst.max(off.abs() / f64::from(s.error));
            let normal = s.normal.as_dvec3();
            assert!(normal.dot(gradient.normalize()) > 1.0 - 1e-4, "{k}: {normal}");
            let mut out = numbers.unit().as_vec3();
            if out.dot(s.normal) < 0.0 {
                out = -out;
            }
            let origin = offset_origin(s.position, s.error, s.normal, out);
            let leaving = Ray { origin, t_min: 0.0, direction: out, t_max: FAR };
            assert!(!occluded(&scene, &leaving), "{k}: met again at once, error {}", s.error);
        }
    }
    assert!(met > 15_000 && missed > 100, "{met} {missed}");
    assert!(worst < 0.6, "the error bound is {worst} of the error");
}

/// Kinds of shapes within a unit or so of the origin.
const KINDS: [&str; 8] = [
    "type = \"sphere\"\ncenter = [0.2, 0.1, 0]\nradius = 0.8",
    "type = \"rectangle\"\norigin = [-0.8, -0.7, 0.1]\nu = [1.5, 0, 0.2]\nv = [0.1, 1.4, 0]",
    "type = \"disc\"\ncenter = [0.1, 0, 0.2]\nnormal = [0.3, 1, -0.4]\nradius = 0.9",
    "type = \"box\"\nmin = [-0.7, -0.4, -0.6]\nmax = [0.5, 0.8, 0.3]",
    "type = \"mesh\"\nfile = \"tent.obj\"",
    "type = \"revolution\"\nprofile = [[0, -0.5], [0.9, -0.2], [0.3, 0.6]]",
    "type = \"cylinder\"\nradius = 0.4\np0 = [-0.5, -0.3, 0.2]\np1 = [0.4, 0.5, -0.1]",
    "type = \"cone\"\nradius = 0.7\ntop_radius = 0.2\nheight = 0.8",
];

/// Smooth faces about a ridge, with texture coordinates.
const TENT: &str = "v -0.8 0 -0.7\nv 0.8 0 -0.7\nv -0.8 0.6 0\nv 0.8 0.5 0\nv -0.8 0 0.7\n\
    v 0.8 0.1 0.7\nvt 0 0\nvt 1 0\nvt 0 0.5\nvt 1 0.5\nvt 0 1\nvt 1 1\nvn 0 0.6 -0.8\nvn 0 1 0\n\
    vn 0 0.6 0.8\nf 1/1/1 3/3/2 4/4/2 2/2/1\nf 3/3/2 5/5/3 6/6/3 4/4/2\n";

/// Theory: under a map p = A q + b, a ray o + t d meets the image of a shape at the t where the ray
/// A^-1 (o - b) + t A^-1 d meets the shape, with the same texture coordinates; its normals are
/// A^-T n, normalized, on the outer side whether A mirrors or not. So each transformed shape gives
/// the hits of the shape itself.
#[test]
fn transformed_shapes_are_images() {
    let folder = crate::support::folder_with("images", &[("tent.obj", TENT)]);
    let packed_of = |shape: &str| {
        let text = format!(
            "{HEAD}{MATERIAL}[textures.t]\ntype = \"checker\"\ncolors = [0.1, 0.9]\n\
             [materials.checked]\ntype = \"diffuse\"\nreflectance = \"t\"\n\
             [[shapes]]\n{shape}\nmaterial = \"checked\"\n"
        );
        packed(&sound(parse(&folder.join("scene.toml"), text.as_bytes())).scene).tables
    };
    let mut numbers = Numbers(0.53);
    for kind in KINDS {
        let plain = packed_of(kind);
        let (mut met, mut unlike) = (0, 0);
        for k in 0..12 {
            let map = numbers.map(4.0);
            let rows: Vec<[f64; 4]> = (0..3)
                .map(|i| [map.x_axis[i], map.y_axis[i], map.z_axis[i], map.translation[i]])
                .collect();
            let moved = packed_of(&format!("{kind}\ntransform = {{ matrix = {rows:?} }}"));
            let inverse = map.inverse();
            for _ in 0..400 {
                let origin = numbers.unit() * 7.0;
                let world = ray(origin, map.transform_point3(numbers.signed()) - origin);
                let (o, d) = (world.origin.as_dvec3(), world.direction.as_dvec3());
                let own = ray(inverse.transform_point3(o), inverse.matrix3 * d);
                match (hit_of(&moved, &world), hit_of(&plain, &own)) {
                    (None, None) => {}
                    (Some((_, a)), Some((_, b))) if alike(&a, &b, &map) => met += 1,
                    // rays along edges and silhouettes
                    _ => unlike += 1,
                }
            }
            assert!(met > 40 * (k + 1), "{kind}: {met} hits after {k} maps, {map:?}");
        }
        assert!(unlike * 100 < met, "{kind}: {unlike} of {met} rays");
    }
}

/// Returns whether surface `a` is the image of surface `b`.
fn alike(a: &Surface, b: &Surface, map: &DAffine3) -> bool {
    let upright = map.matrix3.inverse().transpose();
    let moved = |n: Vec3| (upright * n.as_dvec3()).normalize();
    let shading = moved(b.shading);
    let apart = |x: f32, y: f32| (x - y - (x - y).round()).abs();
    map.transform_point3(b.position.as_dvec3()).distance(a.position.as_dvec3()) < 2e-5
        && a.normal.as_dvec3().distance(moved(b.normal)) < 2e-3
        && a.shading.as_dvec3().distance(shading) < 2e-3
        && apart(a.uv.x, b.uv.x) < 2e-3
        && apart(a.uv.y, b.uv.y) < 2e-3
        && (a.v - b.v).abs() < 2e-3
}

/// Theory: an instance of a group gives the hits of its shapes moved and written out, with the same
/// normals and texture coordinates, for nested groups and mirrors as well.
#[test]
fn groups_equal_shapes_written_out() {
    let block = "type = \"box\"\nmin = [-1, -0.5, -0.2]\nmax = [0.5, 0.5, 0.3]\nmaterial = \"m\"\n";
    let cube = "type = \"mesh\"\nfile = \"cube.obj\"\nmaterial = \"m\"\n";
    let sheet = "type = \"rectangle\"\norigin = [-1, -1, -1]\nu = [2, 0, 0.3]\nv = [0, 2, 0]\n\
                 material = \"m\"\n";
    let inner = "{ translate = [0.3, -0.2, 1.1] }";
    let outer = "{ scale = [-1, 0.5, 0.8] }, { rotate = { axis = [1, 2, 3], degrees = 50 } }, \
                 { translate = [0.2, 0.4, -0.3] }";
    let grouped = scene_of(&format!(
        "[[groups.a.shapes]]\n{block}[[groups.a.shapes]]\n{cube}transform = {inner}\n\
         [[groups.a.shapes]]\n{sheet}[[groups.b.instances]]\ngroup = \"a\"\ntransform = {inner}\n\
         [[instances]]\ngroup = \"b\"\ntransform = [{outer}]\n[[instances]]\ngroup = \"a\"\n"
    ));
    assert_eq!(grouped.shapes.len(), 2);
    let written = scene_of(&format!(
        "[[shapes]]\n{block}transform = [{inner}, {outer}]\n[[shapes]]\n\
         {cube}transform = [{inner}, {inner}, \
         {outer}]\n[[shapes]]\n{sheet}transform = [{inner}, {outer}]\n\
         [[shapes]]\n{block}[[shapes]]\n{cube}transform = {inner}\n[[shapes]]\n{sheet}"
    ));
    let (grouped, written) = (packed(&grouped).tables, packed(&written).tables);
    assert_eq!(grouped.instances.len(), 2);
    assert_eq!(grouped.groups.len(), 1, "the nested group shares its tree");
    assert!(written.instances.is_empty());
    let mut numbers = Numbers(0.71);
    let (mut met, mut unlike) = (0, 0);
    for _ in 0..40_000 {
        let origin = numbers.unit() * 5.0;
        let ray = ray(origin, numbers.signed() * 1.5 - origin);
        match (hit_of(&grouped, &ray), hit_of(&written, &ray)) {
            (None, None) => {}
            (Some((t, a)), Some((u, b)))
                if (t - u).abs() < 1e-4 && a.normal.dot(b.normal) > 0.999_99 =>
            {
                met += 1;
                assert!(a.position.distance(b.position) < 1e-4);
            }
            // rays along edges
            _ => unlike += 1,
        }
    }
    assert!(met > 15_000 && unlike < 40, "{met} {unlike}");
}

/// Theory: a tilted box is the same body as its six faces.
#[test]
fn a_tilted_box_is_six_rectangles() {
    let turn = "[{ rotate = { axis = [1, 2, -1], degrees = 40 } }]";
    let face = |origin: [i32; 3], u: [i32; 3], v: [i32; 3]| {
        format!(
            "[[shapes]]\ntype = \"rectangle\"\norigin = {origin:?}\nu = {u:?}\nv = {v:?}\n\
             material = \"m\"\ntransform = {turn}\n"
        )
    };
    let faces: String = [
        ([0, 0, 0], [0, 0, 3], [0, 2, 0]),
        ([1, 0, 0], [0, 2, 0], [0, 0, 3]),
        ([0, 0, 0], [1, 0, 0], [0, 0, 3]),
        ([0, 2, 0], [0, 0, 3], [1, 0, 0]),
        ([0, 0, 0], [0, 2, 0], [1, 0, 0]),
        ([0, 0, 3], [1, 0, 0], [0, 2, 0]),
    ]
    .iter()
    .map(|(origin, u, v)| face(*origin, *u, *v))
    .collect();
    let block = format!(
        "[[shapes]]\ntype = \"box\"\nmin = [0, 0, 0]\nmax = [1, 2, 3]\nmaterial = \"m\"\n\
         transform = {turn}\n"
    );
    let (block, faces) = (packed(&scene_of(&block)).tables, packed(&scene_of(&faces)).tables);
    let mut numbers = Numbers(0.11);
    let mut met = 0;
    for _ in 0..20_000 {
        let origin = numbers.unit() * 9.0;
        let ray = ray(origin, numbers.signed() * 3.0 - origin);
        if let (Some((t, a)), Some((u, b))) = (hit_of(&block, &ray), hit_of(&faces, &ray)) {
            met += 1;
            assert!((t - u).abs() < 1e-4 && a.normal.dot(b.normal) > 0.999_99);
        }
    }
    assert!(met > 3_000, "{met}");
}

/// Theory: with planes and huge spheres elsewhere, rays that start inside of an instance see its
/// inner side, on both sides of a mirror.
#[test]
fn inner_sides() {
    for mirror in [1.0, -1.0] {
        let map = DAffine3::from_scale(DVec3::new(2.0 * mirror, 1.0, 0.5));
        let scene = of_shapes(vec![instance(vec![ball()], map)]).tables;
        for (direction, t) in [(DVec3::X, 2.0), (DVec3::Y, 1.0), (-DVec3::Z, 0.5)] {
            let (found, s) = hit_of(&scene, &ray(DVec3::ZERO, direction)).unwrap();
            assert!((found - t).abs() < 1e-5, "{found}");
            assert!(s.normal.dot(direction.as_vec3()) > 0.999);
        }
    }
}

/// Theory: instances share the triangles and the tree of their group, so the tables of 10,000
/// instances are those of one and 10,000 entries of the instance table, a reference or two and some
/// nodes each.
#[test]
fn instances_share_memory() {
    const SIDE: u32 = 100;
    let mut text = String::new();
    for k in 0..(SIDE + 1) * (SIDE + 1) {
        let (x, z) = (k % (SIDE + 1), k / (SIDE + 1));
        text += &format!("v {x} {} {z}\n", f64::from(x * z % 7) * 0.1);
    }
    for k in 0..SIDE * SIDE {
        let a = k / SIDE * (SIDE + 1) + k % SIDE + 1;
        text += &format!("f {} {} {} {}\n", a, a + SIDE + 1, a + SIDE + 2, a + 1);
    }
    let folder = crate::support::folder("instances");
    std::fs::write(folder.join("field.obj"), text).unwrap();
    let group =
        "[[groups.field.shapes]]\ntype = \"mesh\"\nfile = \"field.obj\"\nmaterial = \"m\"\n";
    let tables = |count: usize| {
        let places: String = (0..count)
            .map(|k| {
                format!(
                    "[[instances]]\ngroup = \"field\"\ntransform = {{ translate = [{}, 0, {}] }}\n",
                    k % 100 * 101,
                    k / 100 * 101
                )
            })
            .collect();
        let path = folder.join("scene.toml");
        let text = format!("{HEAD}{MATERIAL}{group}{places}");
        packed(&sound(parse(&path, text.as_bytes())).scene).tables
    };
    let (one, many) = (tables(1), tables(10_000));
    assert_eq!(one.triangles.len(), 20_000);
    assert_eq!(many.triangles.len(), one.triangles.len());
    assert_eq!(many.instances.len(), 10_000);
    let bytes = |t: &SceneTables| size_of_val(&t.nodes[..]) + size_of_val(&t.refs[..]);
    let own = size_of_val(&many.instances[..]);
    assert_eq!(own, 10_000 * 128);
    assert!(bytes(&many) < bytes(&one) + 10_000 * 64, "{} {}", bytes(&many), bytes(&one));
    let down = Ray {
        origin: Vec3::new(5050.5, 10.0, 5050.25),
        t_min: 0.0,
        direction: -Vec3::Y,
        t_max: FAR,
    };
    let hit = intersect_scene(&many, &down);
    assert_eq!(kind_of(hit.reference), KIND_INSTANCE);
}
