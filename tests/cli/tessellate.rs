//! `caustica tessellate`.
//!
//! Theory: a profile of straight lines with N sectors is exactly a prism, a pyramid or a frustum:
//! its rings are regular N-gons of circumradius r. An N-gon has the perimeter 2 N r sin(pi/N) and
//! the area N r^2 sin(2 pi/N) / 2; the sides of a pyramid of height h have the apothem sqrt(h^2 +
//! r^2 cos^2(pi/N)). The volume of a curved profile is that of the round body times the ratio of
//! N-gon to circle, within the requested flatness.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::Output;

use crate::support::{caustica, folder, names, repository, sound, text};
use caustica::low_level::scene::{self, Mesh, ShapeKind};
use glam::DVec3;

fn tessellate(folder: &Path, arguments: &[&str]) -> Output {
    caustica(folder, &[&["tessellate"], arguments].concat())
}

/// Loads the OBJ file back through a scene.
fn load_back(obj: &Path, smooth: bool) -> Mesh {
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\nfov = 39\n\
         [environment]\nradiance = 1\n\
         [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"mesh\"\nfile = {:?}\nsmooth = {smooth}\nmaterial = \"m\"\n",
        obj.display().to_string()
    );
    let loaded = scene::parse(Path::new("scene.toml"), text.as_bytes());
    let loaded = sound(loaded);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    match loaded.scene.shapes.into_iter().next().unwrap().kind {
        ShapeKind::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// Tessellates a profile and loads the mesh back as flat triangles in the file's winding.
fn mesh(name: &str, profile: &str, options: &[&str]) -> Mesh {
    let folder = folder(name);
    fs::write(folder.join("p.toml"), profile).unwrap();
    let output = tessellate(&folder, &[&["p.toml", "-o", "p.obj"], options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "p.obj\n");
    load_back(&folder.join("p.obj"), false)
}

/// Area, and the volume on the side opposite to the normals.
fn area_and_volume(mesh: &Mesh) -> (f64, f64) {
    let corners =
        mesh.triangles.iter().map(|t| t.position.map(|index| mesh.positions[index as usize]));
    corners.fold((0.0, 0.0), |(area, volume), [a, b, c]| {
        let normal = (b - a).cross(c - a);
        (area + 0.5 * normal.length(), volume + a.dot(normal) / 6.0)
    })
}

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-9
}

/// Area and perimeter of a regular polygon.
fn polygon(sectors: f64, r: f64) -> (f64, f64) {
    (0.5 * sectors * r * r * (2.0 * PI / sectors).sin(), 2.0 * sectors * r * (PI / sectors).sin())
}

#[test]
fn cylinder() {
    let profile = "segments = [[[0, 0], [2, 0]], [[2, 0], [2, 3]], [[2, 3], [0, 3]]]\n";
    let own = mesh("cylinder", profile, &[]);
    let coarse = mesh("cylinder coarse", profile, &["--sectors", "5"]);
    for (mesh, sectors) in [(&own, 96.0), (&coarse, 5.0)] {
        let (base, perimeter) = polygon(sectors, 2.0);
        let (area, volume) = area_and_volume(mesh);
        assert!(close(area, 2.0 * base + 3.0 * perimeter), "{area}");
        assert!(close(volume, 3.0 * base), "{volume}");
        // The comparison rejects a mesh with one sector more.
        let (more, _) = polygon(sectors + 1.0, 2.0);
        assert!(!close(volume, 3.0 * more));
    }
    assert!((area_and_volume(&own).1 / (12.0 * PI) - 1.0).abs() < 1e-3, "near the round one");
}

/// A cone that stands on its base, scaled by 2 and rotated to lie along x, with its base at x = 10.
#[test]
fn cone_with_transform() {
    let profile = "segments = [[[0, 0], [1.5, 0]], [[1.5, 0], [0, 2]]]\n\
                   transform = { scale = 2, rotate = { axis = [0, 0, 1], degrees = -90 }, translate = [10, 0, 0] }\n";
    let mesh = mesh("cone", profile, &["--sectors", "24"]);
    let (base, perimeter) = polygon(24.0, 3.0);
    let apothem = (16.0 + 9.0 * (PI / 24.0).cos().powi(2)).sqrt();
    let (area, volume) = area_and_volume(&mesh);
    assert!(close(area, base + 0.5 * perimeter * apothem), "{area}");
    assert!(close(volume, base * 4.0 / 3.0), "{volume}");
    let tip = mesh
        .positions
        .iter()
        .copied()
        .fold(DVec3::splat(-1e9), |a, b| if b.x > a.x { b } else { a });
    assert!(tip.distance(DVec3::new(14.0, 0.0, 0.0)) < 1e-9, "{tip}");
    let lowest = mesh.positions.iter().map(|p| p.x).fold(1e9, f64::min);
    assert!((lowest - 10.0).abs() < 1e-9, "{lowest}");
}

/// Theory: the profile (0, 0), (a/2, 0), (a, h) is the paraboloid y = h r^2 / a^2, with half the
/// volume of its cylinder. A finer mesh is closer to it.
#[test]
fn paraboloid_within_the_flatness() {
    let profile = "segments = [[[0, 0], [0.5, 0], [1, 1]], [[1, 1], [0, 1]]]\n";
    let error = |name: &str, flatness: &str| {
        let mesh = mesh(name, profile, &["--sectors", "8", "--flatness", flatness]);
        let (top, _) = polygon(8.0, 1.0);
        (area_and_volume(&mesh).1 / (0.5 * top) - 1.0).abs()
    };
    let (coarse, fine) = (error("bowl", "0.01"), error("fine bowl", "1e-5"));
    assert!(coarse < 0.04 && fine < 4e-5, "{coarse} {fine}");
    assert!(fine < 0.1 * coarse && coarse > 1e-4, "{coarse} {fine}");
}

/// The normals in the file are those of the round surface and point outward.
#[test]
fn normals_are_the_surface_s() {
    let folder = folder("normals");
    fs::write(folder.join("tube.toml"), "profile = [[1, 0], [1, 2]]\n").unwrap();
    let output = tessellate(&folder, &["tube.toml", "--sectors", "7"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "14 vertices, 14 triangles\n");
    let mesh = load_back(&folder.join("tube.obj"), true);
    for triangle in &mesh.triangles {
        for (p, n) in triangle.position.into_iter().zip(triangle.normal.unwrap()) {
            let p = mesh.positions[p as usize];
            assert!(mesh.normals[n as usize].distance(DVec3::new(p.x, 0.0, p.z)) < 1e-6);
        }
        assert!(triangle.uv.is_some());
    }
}

/// Tessellates the shipped profile with default options.
#[test]
fn shipped_profile() {
    let folder = folder("vase");
    let vase = repository("scenes/profiles/vase.toml");
    let output = tessellate(&folder, &[vase.to_str().unwrap()]);
    assert_eq!((output.status.code(), text(&output.stdout).as_str()), (Some(0), "vase.obj\n"));
    let (area, volume) = area_and_volume(&load_back(&folder.join("vase.obj"), false));
    assert!(area > 1.0 && volume > 0.1, "closed and outward: {area} {volume}");
}

/// Runs in a folder that contains only `p.toml`. The command must fail without writing a file or
/// printing a result.
fn fails(name: &str, profile: &str, arguments: &[&str], code: i32, words: &[&str]) {
    let folder = folder(name);
    fs::write(folder.join("p.toml"), profile).unwrap();
    let output = tessellate(&folder, arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    for word in words {
        assert!(error.contains(word), "{name} should say `{word}`: {error}");
    }
    assert_eq!(text(&output.stdout), "");
    assert_eq!(names(&folder).len(), 1, "{name}: only the profile is there");
}

const TUBE: &str = "profile = [[1, 0], [1, 2]]\n";

#[test]
fn wrong_use_is_2() {
    fails("none", TUBE, &[], 2, &["<PROFILE>"]);
    fails(
        "extension",
        TUBE,
        &["p.toml", "-o", "p.ply"],
        2,
        &["p.ply", "a file name that ends in .obj"],
    );
    fails("bare", TUBE, &["missing.toml", "-o", "mesh"], 2, &["a file name that ends in .obj"]);
    fails("sectors", TUBE, &["p.toml", "--sectors", "2"], 2, &["--sectors", "3..=4096"]);
    fails("flatness", TUBE, &["p.toml", "--flatness", "0"], 2, &["1e-6 to 0.1"]);
    fails("negative", TUBE, &["p.toml", "--flatness", "-1"], 2, &["1e-6 to 0.1"]);
    fails("nan", TUBE, &["p.toml", "--flatness", "nan"], 2, &["1e-6 to 0.1"]);
}

#[test]
fn places_that_take_no_file_are_1() {
    fails(
        "folder",
        TUBE,
        &["p.toml", "-o", "no/p.obj"],
        1,
        &["no/p.obj", "the folder `no` does not exist"],
    );
    fails("missing", TUBE, &["q.toml", "-o", "p.obj"], 1, &["q.toml", "did you mean p.toml?"]);
}

/// All faults of a profile are reported with line, column, the line itself and what was expected,
/// as for scene files.
#[test]
fn faults_of_a_profile_are_told_at_once() {
    let many = "profil = [[1, 0], [1, 1]]\nprofile = [[1, 0], [1, nan], [2]]\n\
                transform = { scale = 0, rotate = { axis = [0, 1, 0], degree = 3 } }\n";
    let words = [
        "p.toml: 6 errors",
        "p.toml:1:1",
        "did you mean `profile`?",
        "known keys: `profile`, `segments`, `transform`",
        "p.toml:2:24",
        "profile = [[1, 0], [1, nan], [2]]",
        "expected a finite number",
        "p.toml:2:30",
        "an array of 2 numbers",
        "p.toml:3:23",
        "greater than 0",
        "p.toml:3:55",
        "did you mean `degrees`?",
        "`degrees` is missing in transform.rotate",
    ];
    fails("many", many, &["p.toml"], 1, &words);
    fails(
        "empty",
        "",
        &["p.toml"],
        1,
        &["p.toml:1:1", "the file has neither `profile` nor `segments`"],
    );
    fails(
        "both",
        &format!("{TUBE}segments = [[[1, 0], [1, 2]]]\n"),
        &["p.toml"],
        1,
        &["p.toml:2:12", "has both"],
    );
    fails(
        "material",
        &format!("{TUBE}material = \"m\"\n"),
        &["p.toml"],
        1,
        &["p.toml:2:1", "unknown key `material`"],
    );
    fails("one", "profile = [[1, 0]]\n", &["p.toml"], 1, &["p.toml:1:11", "2 to 16"]);
    fails("axis", "profile = [[0, 0], [0, 1]]\n", &["p.toml"], 1, &["lies on the axis"]);
    fails(
        "gap",
        "segments = [[[1, 0], [1, 1]], [[1, 2], [1, 3]]]\n",
        &["p.toml"],
        1,
        &["1:32", "expected [1, 1]"],
    );
    fails(
        "turn",
        &format!("{TUBE}transform = {{ rotate = {{ axis = [0, 0, 0], degrees = 3 }} }}\n"),
        &["p.toml"],
        1,
        &["p.toml:2:33", "`transform.rotate.axis` has no direction"],
    );
    fails(
        "large",
        "profile = [[1, 0], [1, 1e16]]\n",
        &["p.toml"],
        1,
        &["p.toml:1:24", "too large"],
    );
    fails("not toml", "profile = [[1, 0]\n", &["p.toml"], 1, &["not TOML"]);
    fails(
        "thin",
        "profile = [[1e-12, 0], [1e-12, 1]]\n",
        &["p.toml"],
        1,
        &["p.toml: the profile encloses no surface"],
    );
    let scene = include_str!("../../scenes/cornell.toml");
    fails("scene", scene, &["p.toml"], 1, &["unknown key `camera` in the file"]);
}
