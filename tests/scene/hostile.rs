//! Untrusted scenes: files outside the root are refused under any name, and every limit is checked
//! before memory is allocated.
//!
//! Theory: a path is inside if, with all links resolved, it begins with the root, links resolved.
//! Each way out is paired with a similar one that stays inside and must be read, so a check that
//! refuses everything fails.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{self, HEAD};
use caustica::low_level::scene::{
    Allowance, SceneErrors, load_profile_within, load_within, parse_within,
};

/// A scene with a light, a material and `rest`.
fn lit(rest: &str) -> String {
    let light = "[[lights]]\ntype = \"point\"\nposition = [0, 3, 0]\nintensity = 1.0\n";
    format!("{HEAD}{light}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n{rest}")
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// A folder `root` with a mesh, an image and a profile, and next to it a folder `out` with the
/// same.
fn folders(name: &str) -> (PathBuf, PathBuf) {
    let base = support::folder(name);
    let (root, out) = (base.join("root"), base.join("out"));
    for folder in [&root, &out] {
        fs::create_dir_all(folder.join("sub")).unwrap();
        fs::write(folder.join("mesh.obj"), OBJ).unwrap();
        fs::copy("tests/data/reference/grid.png", folder.join("grid.png")).unwrap();
        fs::write(folder.join("p.toml"), "profile = [[0.0, 0.0], [0.6, 0.0], [0.0, 1.0]]\n")
            .unwrap();
    }
    (root, out)
}

fn mesh(file: &str) -> String {
    lit(&format!("[[shapes]]\ntype = \"mesh\"\nmaterial = \"m\"\nfile = {file:?}\n"))
}

fn picture(file: &str) -> String {
    let sphere =
        "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n";
    lit(&format!("{sphere}[environment]\nfile = {file:?}\n"))
}

fn within(root: &Path) -> Allowance {
    Allowance { root: Some(root.to_owned()), ..Allowance::default() }
}

fn refusal(errors: SceneErrors) -> String {
    let finding = &errors.errors[0];
    format!(
        "{:?} {finding} | {} | {}",
        finding.line_column(),
        finding.label(),
        finding.help().unwrap_or("")
    )
}

/// The first error of a scene in `root/scene.toml`; none if it loads.
fn reported(root: &Path, text: &str, allowance: &Allowance) -> Option<String> {
    parse_within(&root.join("scene.toml"), text.as_bytes(), allowance).err().map(refusal)
}

fn assert_refused(root: &Path, text: &str, line: usize) {
    let reported = reported(root, text, &within(root)).unwrap_or_else(|| panic!("read: {text}"));
    assert!(reported.contains("lies outside of") && reported.contains("--root"), "{reported}");
    assert!(reported.starts_with(&format!("Some(({line},")), "{reported}");
}

/// Paths with `..`, absolute paths and links, of meshes and images.
#[test]
fn what_lies_outside_is_refused() {
    let (root, out) = folders("paths");
    for name in ["mesh.obj", "grid.png"] {
        let (scene, line): (fn(&str) -> String, _) =
            if name == "mesh.obj" { (mesh, 16) } else { (picture, 19) };
        let outside = [
            format!("../out/{name}"),
            format!("sub/../../out/{name}"),
            out.join(name).display().to_string(),
            // The message does not reveal whether a file outside the root exists.
            format!("../nowhere/{name}"),
            format!("/nowhere/{name}"),
        ];
        for file in &outside {
            assert_refused(&root, &scene(file), line);
        }
        for file in [
            name.to_owned(),
            format!("sub/../{name}"),
            format!("../root/{name}"),
            root.join(name).display().to_string(),
        ] {
            assert_eq!(reported(&root, &scene(&file), &within(&root)), None, "{file}");
        }
        // Without a root all existing files load.
        for file in &outside[..3] {
            assert_eq!(reported(&root, &scene(file), &Allowance::default()), None, "{file}");
        }
    }
}

#[cfg(unix)]
#[test]
fn links_are_followed_before_they_are_judged() {
    use std::os::unix::fs::symlink;
    let (root, out) = folders("links");
    symlink(out.join("mesh.obj"), root.join("out.obj")).unwrap();
    symlink("../out", root.join("away")).unwrap();
    symlink("mesh.obj", root.join("in.obj")).unwrap();
    symlink("sub", root.join("near")).unwrap();
    fs::write(root.join("sub/mesh.obj"), OBJ).unwrap();
    for file in ["out.obj", "away/mesh.obj", "away/nothing.obj", "near/../away/mesh.obj"] {
        assert_refused(&root, &mesh(file), 16);
    }
    for file in ["in.obj", "near/mesh.obj"] {
        assert_eq!(reported(&root, &mesh(file), &within(&root)), None, "{file}");
    }
    // A root that is itself a link stands for its target.
    symlink(&root, root.with_file_name("link")).unwrap();
    assert_eq!(reported(&root, &mesh("in.obj"), &within(&root.with_file_name("link"))), None);
    // The scene's own file, and a profile.
    fs::write(out.join("scene.toml"), mesh("mesh.obj")).unwrap();
    symlink(out.join("scene.toml"), root.join("scene.toml")).unwrap();
    let errors = load_within(&root.join("scene.toml"), &within(&root)).unwrap_err();
    assert!(refusal(errors).contains("lies outside of"));
    assert!(load_within(&out.join("scene.toml"), &within(&out)).is_ok());
    assert!(
        refusal(load_profile_within(&out.join("p.toml"), &within(&root)).unwrap_err())
            .contains("lies outside of")
    );
    assert!(load_profile_within(&root.join("p.toml"), &within(&root)).is_ok());
}

/// The MTL file of an OBJ file, and the image of an MTL file.
#[test]
fn files_named_by_meshes_are_confined_too() {
    let (root, _) = folders("mtl");
    let scene = mesh("own.obj").replace("material = \"m\"\n", "");
    let own = |library: &str| {
        fs::write(root.join("own.obj"), format!("mtllib {library}\nusemtl a\n{OBJ}")).unwrap()
    };
    let library = |picture: &str| {
        fs::write(root.join("own.mtl"), format!("newmtl a\nmap_Kd {picture}\n")).unwrap()
    };
    let first = |line: usize, file: &str| {
        let errors =
            parse_within(&root.join("scene.toml"), scene.as_bytes(), &within(&root)).unwrap_err();
        assert!(errors.errors[0].file().ends_with(file), "{}", errors.errors[0].file());
        let reported = refusal(errors);
        assert!(
            reported.contains("lies outside of") && reported.starts_with(&format!("Some(({line},")),
            "{reported}"
        );
    };
    own("own.mtl");
    library("grid.png");
    assert_eq!(reported(&root, &scene, &within(&root)), None);
    library("../out/grid.png");
    first(2, "own.mtl");
    library("grid.png");
    fs::copy(root.join("own.mtl"), root.with_file_name("out").join("own.mtl")).unwrap();
    own("../out/own.mtl");
    first(1, "own.obj");
}

/// Folders and pipes; reading a pipe would block.
#[cfg(unix)]
#[test]
fn only_regular_files_are_read() {
    let (root, _) = folders("kinds");
    for (scene, file) in [
        (mesh as fn(&str) -> String, "sub"),
        (picture, "sub"),
        (mesh, "/dev/zero"),
        (picture, "/dev/zero"),
    ] {
        let reported = reported(&root, &scene(file), &Allowance::default()).unwrap();
        assert!(reported.contains("it is not a regular file"), "{reported}");
    }
}

/// Each limit at the scene's value, which loads, and one less, which is refused by the limit's
/// name.
#[test]
fn limits_are_told_by_name() {
    let (root, _) = folders("limits");
    let size = image::image_dimensions(root.join("grid.png")).unwrap();
    let pixels = u64::from(size.0) * u64::from(size.1);
    let encoded = fs::metadata(root.join("grid.png")).unwrap().len();
    let two = mesh("mesh.obj") + &mesh("mesh.obj")[lit("").len()..];
    let cases = [
        ("shapes", two.clone(), 2),
        ("mesh-bytes", two.clone(), 2 * OBJ.len() as u64),
        ("mesh-triangles", two.clone(), 2),
        ("triangles", two, 4),
        ("texture-pixels", picture("grid.png"), pixels),
        ("texture-bytes", picture("grid.png"), (4 * pixels).max(encoded)),
        ("picture-pixels", mesh("mesh.obj") + "[film]\nwidth = 30\nheight = 20\n", 600),
    ];
    for (name, scene, exact) in cases {
        let reported = |value: u64| {
            let mut allowance = within(&root);
            *allowance.limit(name).unwrap() = value;
            reported(&root, &scene, &allowance)
        };
        assert_eq!(reported(exact), None, "{name}");
        let message = reported(exact - 1);
        let message = message.unwrap_or_else(|| panic!("{name} = {} is not reported", exact - 1));
        assert!(message.contains(&format!("--limit {name}=N")), "{message}");
    }
    let scene = mesh("mesh.obj");
    fs::write(root.join("scene.toml"), &scene).unwrap();
    let load = |bytes: u64| {
        load_within(&root.join("scene.toml"), &Allowance { scene_bytes: bytes, ..within(&root) })
    };
    assert!(load(scene.len() as u64).is_ok());
    assert!(refusal(load(scene.len() as u64 - 1).unwrap_err()).contains("--limit scene-bytes=N"));
}

/// The header of an image is checked before its pixels: 100000 x 100000 in a few bytes.
#[test]
fn a_picture_that_claims_much_is_refused_by_its_header() {
    let (root, _) = folders("claims");
    let mut claims = fs::read(root.join("grid.png")).unwrap();
    claims[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    let crc = !claims[12..29].iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    });
    claims[29..33].copy_from_slice(&crc.to_be_bytes());
    fs::write(root.join("claims.png"), claims).unwrap();
    let reported = reported(&root, &picture("claims.png"), &within(&root)).unwrap();
    assert!(
        reported.contains("10000000000 pixels") && reported.contains("texture-pixels"),
        "{reported}"
    );
}

/// The first errors are listed and all are counted, whichever stage reports them.
#[test]
fn errors_beyond_the_limit_are_counted() {
    let bad: String = (0..5000)
        .map(|n| {
            format!(
                "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, {n}]\nradius = -1\n\
                     material = \"m\"\n"
            )
        })
        .collect();
    let text = lit(&bad);
    for (most, listed) in [(7, 7), (0, 1), (10_000, 5000)] {
        let allowance = Allowance { errors: most, ..Allowance::default() };
        let errors = parse_within("scene.toml".as_ref(), text.as_bytes(), &allowance).unwrap_err();
        assert_eq!((errors.errors.len(), errors.more), (listed, 5000 - listed));
        assert!(errors.to_string().contains("5000 errors"), "{errors}");
        assert_eq!(errors.errors[0].line_column(), Some((16, 10)));
    }
}

/// A place in a line of a megabyte is shown with its surroundings only.
#[test]
fn long_lines_are_cut() {
    let numbers = "[0, 0], ".repeat(100_000);
    let text = lit(&format!(
        "[[shapes]]\ntype = \"revolution\"\nmaterial = \"m\"\nprofile = [{numbers}[0, 'here']]\n"
    ));
    let errors =
        parse_within("scene.toml".as_ref(), text.as_bytes(), &Allowance::default()).unwrap_err();
    let report = format!("{:?}", miette::Report::new(errors));
    assert!(report.len() < 20_000 && report.contains("here"), "{} bytes", report.len());
}

/// One face of many corners without an ear: ear clipping would take time cubic in their number.
#[test]
fn faces_too_intricate_are_refused() {
    let (root, _) = folders("ears");
    let count = 6000;
    let mut obj = String::new();
    for n in 0..count {
        // A spiral with many turns, which intersects itself wherever it closes.
        let angle = f64::from(n) * 2.4;
        let radius = 1.0 + f64::from(n % 7);
        obj +=
            &format!("v {} {} {}\n", radius * angle.cos(), radius * angle.sin(), f64::from(n % 5));
    }
    obj += "f";
    (1..=count).for_each(|n| obj += &format!(" {n}"));
    fs::write(root.join("mesh.obj"), obj + "\n").unwrap();
    let reported = reported(&root, &mesh("mesh.obj"), &within(&root)).unwrap();
    assert!(reported.contains("too intricate") && reported.contains("triangulate"), "{reported}");
}
