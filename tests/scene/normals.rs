//! Computed normals of meshes: smoothing groups and crease angles.
//!
//! Theory: the normal at a corner is the sum of the normals of the faces that it shares, weighted
//! by their angles there (Thuermer & Wuethrich 1998), so it does not depend on how the faces are
//! cut into triangles. Groups and creases decide which faces share it.

use std::collections::BTreeMap;
use std::fs;

use caustica::low_level::scene::{Allowance, Loaded, Mesh, SceneErrors, ShapeKind, parse_within};
use glam::DVec3;

use crate::support::{HEAD, folder};

fn load(name: &str, file: &str, content: &str, more: &str) -> Result<Loaded, SceneErrors> {
    let folder = folder(name);
    fs::write(folder.join(file), content).unwrap();
    let text = format!(
        "{HEAD}[environment]\nradiance = 1\n[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"mesh\"\nmaterial = \"m\"\nfile = {file:?}\n{more}"
    );
    parse_within(&folder.join("scene.toml"), text.as_bytes(), &Allowance::default())
}

fn mesh_of(loaded: &Loaded) -> &Mesh {
    let ShapeKind::Mesh(mesh) = &loaded.scene.shapes[0].kind else { panic!("no mesh") };
    mesh
}

/// Unit normal of the face and shading normal (that of the face if it is flat) at each corner of
/// each triangle, by position.
type Corners = Vec<(DVec3, DVec3, DVec3)>;

fn corners(name: &str, obj: &str, more: &str) -> Corners {
    let loaded = load(name, "m.obj", obj, more).unwrap_or_else(|error| panic!("{error:?}"));
    let mesh = mesh_of(&loaded);
    let mut all = Vec::new();
    for triangle in &mesh.triangles {
        let p = triangle.position.map(|at| mesh.positions[at as usize]);
        let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
        for corner in 0..3 {
            let normal = triangle.normal.map(|normals| mesh.normals[normals[corner] as usize]);
            all.push((p[corner], face, normal.unwrap_or(face)));
        }
    }
    all
}

fn assert_normals(corners: &Corners, expected: impl Fn(DVec3, DVec3) -> DVec3) {
    assert!(!corners.is_empty());
    for (position, face, normal) in corners {
        let expected = expected(*position, *face);
        assert!(normal.distance(expected) < 1e-12, "{position}: {normal}, expected {expected}");
    }
}

/// Two squares that meet at the z axis, with an angle between their normals: the one is in the
/// plane y = 0, the other falls off to the right.
fn roof(degrees: f64, first: &str, second: &str) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        "v 0 0 0\nv 0 0 1\nv -1 0 1\nv -1 0 0\nv {cos} {0} 1\nv {cos} {0} 0\n{first}f 1 4 3 2\n\
         {second}f 1 2 5 6\n",
        -sin
    )
}

/// The normal of the face.
fn flat(_: DVec3, face: DVec3) -> DVec3 {
    face
}

/// The squares of a roof share the normal halfway between theirs at the ridge.
fn ridge(degrees: f64) -> impl Fn(DVec3, DVec3) -> DVec3 {
    let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
    move |position, face| if position.x == 0.0 { DVec3::new(sin, cos, 0.0) } else { face }
}

#[test]
fn groups_share_normals() {
    for degrees in [20.0, 90.0, 130.0] {
        for (first, second) in [("", ""), ("s 1\n", ""), ("s 7\n", "g b\ns 7\n"), ("s x\n", "s\n")]
        {
            let found = corners("groups", &roof(degrees, first, second), "");
            assert_normals(&found, ridge(degrees));
        }
        let apart = [("s 1\n", "s 2\n"), ("", "s 1\n"), ("s off\n", ""), ("s 0\n", "s 1\n")];
        for (first, second) in apart {
            let found = corners("groups", &roof(degrees, first, second), "");
            assert_normals(&found, flat);
        }
        // The file's own normals count, whatever the group.
        let own = roof(degrees, "vn 0 0.6 0.8\ns off\n", "s 2\n");
        let own =
            own.replace("1 4 3 2", "1//1 4//1 3//1 2//1").replace("1 2 5 6", "1//1 2//1 5//1 6//1");
        assert_normals(&corners("groups", &own, ""), |_, _| DVec3::new(0.0, 0.6, 0.8));
    }
    // A group that is not known is reported, and the group before it goes on.
    let loaded = load("unknown", "m.obj", &roof(20.0, "s 1\n", "s one\n"), "").unwrap();
    let warnings: Vec<_> = loaded.warnings.iter().map(|w| (w.line_column(), w.message())).collect();
    assert_eq!(warnings, [(Some((9, 3)), "`one` is no smoothing group")]);
}

/// Faces without a group are flat and leave the others alone: a cube whose top is flat.
#[test]
fn flat_faces_take_no_part() {
    let found = corners("cube", CUBE, "");
    assert_normals(&found, |position, _| position.normalize());
    let found = corners("cube", &CUBE.replace("f 3 7 8 4", "s off\nf 3 7 8 4"), "");
    assert_normals(&found, |position, face| {
        let without_top = DVec3::new(position.x, 0.0, position.z).normalize();
        match (face.y > 0.5, position.y > 0.0) {
            (true, _) => DVec3::Y,
            (false, true) => without_top,
            (false, false) => position.normalize(),
        }
    });
}

/// Corners at (+-1, +-1, +-1); the top is the last face.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\n\
                    v 1 1 1\n\
f 1 2 6 5\nf 1 3 4 2\nf 5 6 8 7\nf 1 5 7 3\nf 2 4 8 6\nf 3 7 8 4\n";

#[test]
fn creases_part_faces() {
    for degrees in [1.0, 29.0, 90.0, 150.0] {
        let angle = |more: f64| format!("crease_angle = {:?}\n", degrees + more);
        assert_normals(&corners("roof", &roof(degrees, "", ""), &angle(0.1)), ridge(degrees));
        assert_normals(&corners("roof", &roof(degrees, "", ""), &angle(-0.1)), flat);
        // groups part faces too
        assert_normals(&corners("roof", &roof(degrees, "s 1\n", "s 2\n"), &angle(0.1)), flat);
        assert_normals(&corners("roof", &roof(degrees, "", "s off\n"), &angle(0.1)), flat);
    }
    // The edges of a box are creases at 90 degrees, and not above. The diagonals of its faces have
    // no effect: each face has a right angle at each corner.
    assert_normals(&corners("box", CUBE, "crease_angle = 90.0\n"), flat);
    assert_normals(&corners("box", CUBE, "crease_angle = 91\n"), |p, _| p.normalize());
    assert_normals(&corners("box", CUBE, "crease_angle = 0\n"), flat);
}

/// A prism with 24 sides and two lids: at 30 degrees its sides, which differ by 15 degrees, share
/// the radial normal, and its lids are flat. Two faces at a corner share a normal if a way of soft
/// edges leads from one to the other, although they differ by more.
#[test]
fn a_prism_is_a_cylinder() {
    let sides = 24;
    let mut obj = String::new();
    for k in 0..sides {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
        obj += &format!("v {cos} 0 {sin}\nv {cos} 2 {sin}\n");
    }
    let at = |k: i32, top: i32| 2 * (k % sides) + top + 1;
    for k in 0..sides {
        obj += &format!("f {} {} {} {}\n", at(k, 0), at(k, 1), at(k + 1, 1), at(k + 1, 0));
    }
    let lid = |top: i32| (0..sides).map(move |k| at(k, top).to_string());
    obj += &format!("f {}\n", lid(0).collect::<Vec<_>>().join(" "));
    obj += &format!("f {}\n", lid(1).rev().collect::<Vec<_>>().join(" "));
    let found = corners("prism", &obj, "crease_angle = 30.0\n");
    assert_normals(&found, |position, face| {
        if face.y.abs() > 0.5 { face } else { DVec3::new(position.x, 0.0, position.z) }
    });
    // A pyramid over the same ring: at its apex all sides share the normal upward.
    let mut obj: String =
        obj.lines().filter(|line| line.starts_with("v ")).map(|line| format!("{line}\n")).collect();
    obj += "v 0 1 0\n";
    for k in 0..sides {
        obj += &format!("f {} {} {}\n", 2 * sides + 1, at(k + 1, 0), at(k, 0));
    }
    let found = corners("pyramid", &obj, "crease_angle = 15.0\n");
    let apex: Vec<_> = found.iter().filter(|(position, ..)| position.y == 1.0).copied().collect();
    assert_eq!(apex.len(), sides as usize);
    assert_normals(&apex, |_, _| DVec3::Y);
}

/// Normals are weighted by the angles of the corners: at the tip of a pyramid with corners on the
/// axes at different distances.
#[test]
fn angles_are_weights() {
    let points =
        [DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -1.0), DVec3::new(-1.0, 0.0, 0.5)];
    let tip = DVec3::new(0.0, 0.75, 0.0);
    let mut obj = format!("v 0 {} 0\n", tip.y);
    points.iter().for_each(|p| obj += &format!("v {} {} {}\n", p.x, p.y, p.z));
    obj += "f 1 2 3\nf 1 3 4\nf 1 4 2\n";
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| [points[a] - tip, points[b] - tip]);
    let sum: DVec3 = sides
        .iter()
        .map(|[a, b]| a.cross(*b).normalize() * a.normalize().dot(b.normalize()).acos())
        .sum();
    for more in ["", "crease_angle = 180\n"] {
        let found = corners("weights", &obj, more);
        let tips: Vec<_> = found.iter().filter(|(p, ..)| *p == tip).copied().collect();
        assert_normals(&tips, |_, _| sum.normalize());
    }
}

/// An edge of three faces is a crease for all of them; the normals of the file are replaced, but
/// still define the outside.
#[test]
fn creases_replace_normals_of_the_file() {
    let fin = roof(20.0, "", "") + "v 0 1 0\nv 0 1 1\nf 1 7 8 2\n";
    assert_normals(&corners("fin", &fin, "crease_angle = 170\n"), flat);
    let own = "v 0 0 0\nv 1 0 0\nv 0 0 1\nvn 0 0.8 0.6\nf 1//1 2//1 3//1\n";
    let found = corners("own", own, "");
    assert_normals(&found, |_, _| DVec3::new(0.0, 0.8, 0.6));
    let found = corners("own", own, "crease_angle = 30\n");
    assert!(found.iter().all(|(_, face, _)| *face == DVec3::Y));
}

/// A PLY file has the same normals.
#[test]
fn formats_agree() {
    let mut ply = String::from("ply\nformat ascii 1.0\nelement vertex 8\n");
    ply += "property double x\nproperty double y\nproperty double z\nelement face 6\n";
    ply += "property list uchar uchar vertex_index\nend_header\n";
    for line in CUBE.lines() {
        let mut words = line.split(' ');
        let numbers: Vec<i32> = words.by_ref().skip(1).map(|word| word.parse().unwrap()).collect();
        let row: Vec<_> = match numbers[..] {
            [_, _, _] => numbers.iter().map(ToString::to_string).collect(),
            _ => std::iter::once(4)
                .chain(numbers.iter().map(|n| n - 1))
                .map(|n| n.to_string())
                .collect(),
        };
        ply += &format!("{}\n", row.join(" "));
    }
    for more in ["", "crease_angle = 60\n", "crease_angle = 100\n", "smooth = false\n"] {
        let [ply, obj] = [("m.ply", ply.as_str()), ("m.obj", CUBE)]
            .map(|(file, content)| load("formats", file, content, more).unwrap());
        assert_eq!(mesh_of(&ply), mesh_of(&obj), "{more}");
    }
}

#[test]
fn wrong_angles_are_reported() {
    let cases = BTreeMap::from([
        ("crease_angle = 181\n", "expected a number from 0 to 180"),
        ("crease_angle = -1\n", "expected a number from 0 to 180"),
        ("crease_angle = nan\n", "expected a finite number"),
        ("smooth = false\ncrease_angle = 30\n", "expected a smooth mesh"),
    ]);
    for (more, expected) in cases {
        let errors = load("wrong", "m.obj", CUBE, more).err().unwrap();
        let error = &errors.errors[0];
        assert!(errors.errors.len() == 1 && error.label().contains(expected), "{error:?}");
        assert_eq!(error.line_column().unwrap().1, 16, "{error:?}");
    }
}
