//! Transforms of shapes: the shapes that they become, and errors.

use crate::support::{HEAD, data, sound};
use caustica::low_level::scene::{Mesh, Scene, ShapeKind, parse};
use glam::{DAffine3, DMat3, DVec2, DVec3};

const HEADER: &str = "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[lights]]\n\
                      type = \"point\"\nposition = [0, 9, 0]\nintensity = 1\n[textures.t]\n\
                      type = \"checker\"\ncolors = [0.1, 0.9]\n[materials.checked]\n\
                      type = \"diffuse\"\nreflectance = \"t\"\n";

fn text_of(shape: &str) -> String {
    format!("{HEAD}{HEADER}[[shapes]]\n{shape}\n")
}

fn scene_of(shape: &str) -> Scene {
    sound(parse(&data("scene.toml"), text_of(shape).as_bytes())).scene
}

fn kind_of(shape: &str) -> ShapeKind {
    scene_of(shape).shapes.swap_remove(0).kind
}

fn mesh_of(shape: &str) -> Mesh {
    match kind_of(shape) {
        ShapeKind::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// Six times the volume that a closed mesh encloses, positive if it faces outward.
fn volume(mesh: &Mesh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
    mesh.triangles.iter().map(|t| corners(&t.position)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

const STEPS: &str = "[{ scale = [1, 2, -3] }, { rotate = { axis = [1, 1, 0], degrees = 25 } }, \
                     { translate = [1, 2, 3] }]";

fn steps() -> DAffine3 {
    let axis = DVec3::new(1.0, 1.0, 0.0).normalize();
    DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))
        * DAffine3::from_axis_angle(axis, 25f64.to_radians())
        * DAffine3::from_scale(DVec3::new(1.0, 2.0, -3.0))
}

/// Theory: steps apply in their order; a matrix with the same entries gives the same shape. A
/// mirrored rectangle covers the same points, and its normal follows the inverse transpose.
#[test]
fn steps_and_matrices() {
    let map = steps();
    let rows: Vec<[f64; 4]> =
        (0..3).map(|i| [map.x_axis[i], map.y_axis[i], map.z_axis[i], map.translation[i]]).collect();
    let (corner, s, t) = (DVec3::new(0.5, 0.0, 1.0), DVec3::X * 2.0, DVec3::new(0.0, 1.0, 1.0));
    let upright = map.matrix3.inverse().transpose() * s.cross(t);
    for transform in [STEPS.to_owned(), format!("{{ matrix = {rows:?} }}")] {
        let kind = kind_of(&format!(
            "type = \"rectangle\"\norigin = [0.5, 0, 1]\nu = [2, 0, 0]\nv = [0, 1, 1]\n\
             material = \"m\"\ntransform = {transform}"
        ));
        let ShapeKind::Rectangle { origin, u, v } = kind else { panic!("{kind:?}") };
        let middle = map.transform_point3(corner + 0.5 * (s + t));
        assert!((origin + 0.5 * (u + v)).distance(middle) < 1e-12);
        let linear = map.matrix3;
        assert!((linear * s + u).length() < 1e-12 && (linear * t).distance(v) < 1e-12);
        assert!(u.cross(v).normalize().distance(upright.normalize()) < 1e-12);
    }
}

/// Theory: a map multiplies the volume of a closed body by the magnitude of its determinant, and a
/// mirrored body still faces outward.
#[test]
fn bodies_keep_their_sides() {
    let factor = steps().matrix3.determinant().abs();
    let cube = "type = \"mesh\"\nfile = \"cube.obj\"\nmaterial = \"m\"\n";
    let before = volume(&mesh_of(cube));
    assert!(before > 0.0);
    let after = mesh_of(&format!("{cube}transform = {STEPS}"));
    assert!((volume(&after) / (factor * before) - 1.0).abs() < 1e-12);
    let block = "type = \"box\"\nmin = [0, 1, 2]\nmax = [1, 3, 5]\nmaterial = \"checked\"\n";
    let tilted = mesh_of(&format!("{block}transform = {STEPS}"));
    assert!((volume(&tilted) / (factor * 36.0) - 1.0).abs() < 1e-12);
}

/// Theory: a tilted box has the texture coordinates of the straight one. On its front, the face
/// towards +z, u runs along +x and v along +y; on top v runs along -z.
#[test]
fn texture_coordinates_of_tilted_boxes() {
    let turn = "[{ rotate = { axis = [0, 0, 1], degrees = 30 } }]";
    let block = "type = \"box\"\nmin = [0, 0, 0]\nmax = [2, 3, 5]\nmaterial = \"checked\"\n";
    let mesh = mesh_of(&format!("{block}transform = {turn}"));
    let back = DMat3::from_rotation_z(-30f64.to_radians());
    let mut seen = 0;
    for triangle in &mesh.triangles {
        let p = triangle.position.map(|i| back * mesh.positions[i as usize]);
        let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
        let uv = triangle.uv.unwrap().map(|i| mesh.uvs[i as usize]);
        for (p, uv) in p.iter().zip(uv) {
            let q = *p / DVec3::new(2.0, 3.0, 5.0);
            let expected = match normal.abs().max_position() {
                0 => DVec2::new(if normal.x > 0.0 { 1.0 - q.z } else { q.z }, q.y),
                1 => DVec2::new(q.x, if normal.y > 0.0 { 1.0 - q.z } else { q.z }),
                _ => DVec2::new(if normal.z > 0.0 { q.x } else { 1.0 - q.x }, q.y),
            };
            assert!(uv.distance(expected) < 1e-12, "{normal}: {p} {uv}");
            seen += 1;
        }
    }
    assert_eq!(seen, 36);
}

/// Theory: spheres and surfaces of revolution stay exact under similar maps, also mirrored ones;
/// the latter also if the map stretches their axis.
#[test]
fn exact_shapes_stay_exact() {
    let ball = "type = \"sphere\"\ncenter = [1, 0, 0]\nradius = 1\nmaterial = \"m\"\n";
    let kind = kind_of(&format!("{ball}transform = {{ scale = [-2, 2, 2] }}"));
    assert_eq!(kind, ShapeKind::Sphere { center: DVec3::X * -2.0, radius: 2.0 });
    let can = "type = \"revolution\"\nprofile = [[1, 0], [2, 3]]\nmaterial = \"m\"\n";
    for (sign, y) in [(1.0, 5.0), (-1.0, 5.0), (1.0, -5.0)] {
        let kind = kind_of(&format!("{can}transform = [{{ scale = [2, {y}, {}] }}]", 2.0 * sign));
        let ShapeKind::Revolution { segments, transform, .. } = kind else { panic!("{kind:?}") };
        for p in &segments[0] {
            let top = transform.point(DVec3::new(0.0, p.y, 0.0));
            assert!((top.y - if p.x > 1.5 { 3.0 * y } else { 0.0 }).abs() < 1e-12);
            assert!((transform.scale - 2.0).abs() < 1e-12);
        }
        assert!((transform.rotation.determinant() - 1.0).abs() < 1e-12);
    }
}

/// Each error is reported at the transform.
#[test]
fn faults() {
    let ball = "type = \"sphere\"\ncenter = [1, 0, 0]\nradius = 1\nmaterial = \"m\"\ntransform = ";
    for (transform, place, expected) in [
        ("{ scale = [1, 0, 1] }", (24, 13), "is singular"),
        ("{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]] }", (24, 13), "is singular"),
        ("{ scale = [1, nan, 1] }", (24, 27), "finite"),
        ("{ matrix = [[inf,0,0,0], [0,1,0,0], [0,0,1,0]] }", (24, 26), "finite"),
        ("[{ scale = [1e15, 1, 1] }, { scale = 1e15 }]", (24, 13), "too large"),
        (
            "[{ matrix = [[1,0,0,0], [0,1,0,0], [0,0,1,0], [1,2,3,1]] }]",
            (24, 25),
            "expected the last row [0, 0, 0, 1]",
        ),
        ("{ matrix = [[1,0,0,0], [0,1,0,0]] }", (24, 24), "expected an array of 3 to 4"),
        (
            "[{}, { rotate = { axis = [0, 0, 0], degrees = 1 } }]",
            (24, 38),
            "`shapes[0].transform[1].rotate.axis` has no direction",
        ),
        ("[{ skale = 2 }]", (24, 16), "did you mean `scale`?"),
        ("3", (24, 13), "expected a table or an array"),
    ] {
        let errors = parse(&data("scene.toml"), text_of(&format!("{ball}{transform}")).as_bytes());
        let errors = errors.err().unwrap_or_else(|| panic!("{transform}: no error"));
        let [finding] = &errors.errors[..] else { panic!("{transform}: {errors:?}") };
        let text = format!("{} | {}", finding.message(), finding.label());
        assert!(text.contains(expected), "{transform}: {text}");
        assert_eq!(finding.line_column(), Some(place), "{transform}");
    }
}
