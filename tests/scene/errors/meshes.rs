//! OBJ and MTL files in the form that programs write: names, comments, line ends, missing files,
//! values out of range.
//!
//! Theory: layout is not content. A name is the bytes after its keyword, and the first material of
//! a name, in the order of the libraries, counts. A statement that does not affect the image causes
//! no error.

use std::path::Path;

use caustica::low_level::scene::{
    Allowance, Loaded, MaterialKind, Missing, Reflectance, Rgb, SceneErrors, ShapeKind,
    parse_within,
};

use super::{HEAD, differs, reported};
use crate::support::{ends, folder, sound};

const SQUARES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";
const RED: Rgb = [1.0, 0.0, 0.0];
const GREEN: Rgb = [0.0, 1.0, 0.0];
const GRAY: Rgb = [0.5; 3];

/// A folder with these files.
pub fn written(name: &str, files: &[(&str, &[u8])]) -> std::path::PathBuf {
    let folder = folder(name);
    for (file, bytes) in files {
        let file = folder.join(file);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, bytes).unwrap();
    }
    folder
}

fn read(folder: &Path, missing: Missing) -> Result<Loaded, SceneErrors> {
    let text = format!(
        "{HEAD}[environment]\nradiance = 1\n[[shapes]]\ntype = \"mesh\"\nfile = \"m.obj\"\n"
    );
    let allowance = Allowance { missing, ..Allowance::default() };
    parse_within(&folder.join("scene.toml"), text.as_bytes(), &allowance)
}

/// Colours and triangle counts of the parts of `m.obj`, and the warnings.
fn parts(folder: &Path, missing: Missing) -> (Vec<(Rgb, usize)>, Vec<String>) {
    let loaded = sound(read(folder, missing));
    let scene = &loaded.scene;
    let part = |shape: &caustica::low_level::scene::Shape| {
        let ShapeKind::Mesh(mesh) = &shape.kind else { panic!() };
        let MaterialKind::Diffuse { reflectance: Reflectance::Color(color), .. } =
            scene.materials[shape.material].kind
        else {
            panic!("{:?}", scene.materials[shape.material])
        };
        (color, mesh.triangles.len())
    };
    (scene.shapes.iter().map(part).collect(), loaded.warnings.iter().map(reported).collect())
}

/// The parts of a mesh with one library.
fn parts_of(name: &str, obj: &[u8], mtl: &[u8]) -> (Vec<(Rgb, usize)>, Vec<String>) {
    parts(&written(name, &[("m.obj", obj), ("m.mtl", mtl)]), Missing::Error)
}

fn two(name: &str, first: &[u8], second: &[u8]) -> Vec<(Rgb, usize)> {
    let mtl = [b"newmtl ", first, b"\nKd 1 0 0\nnewmtl ", second, b"\nKd 0 1 0\n"].concat();
    let (before, between) = (b"mtllib m.mtl\nusemtl ", b"\nf 1 2 3 4\nusemtl ");
    let obj = [SQUARES.as_bytes(), before, first, between, second, b"\nf 2 5 6 3\n"].concat();
    let (parts, warnings) = parts_of(name, &obj, &mtl);
    assert_eq!(warnings, [""; 0], "{name}");
    parts
}

/// Two names that differ are two materials.
#[test]
fn names_stay_apart() {
    let names: [(&[u8], &[u8]); 9] = [
        (b"Grey #1", b"Grey #2"),
        (b"Grey", b"Grey #2"),
        (b"#1", b"#2"),
        (b"a#1", b"a#2"),
        (b"a b", b"a c"),
        (b"\xe9", b"\xe8"),
        (b"\xe9", b"\xc3\xa9"),
        (b"\x83\x85", b"\x83"),
        (b"a\\b", b"a\\c"),
    ];
    for (number, (first, second)) in names.into_iter().enumerate() {
        let found = two(&format!("names {number}"), first, second);
        assert_eq!(found, [(RED, 2), (GREEN, 2)], "{}", String::from_utf8_lossy(first));
    }
}

/// One file in several layouts.
#[test]
fn layout_is_no_content() {
    let mtl = b"newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n";
    let lines = format!("mtllib m.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\nusemtl b\nf 2 5 6 3\n");
    let layouts = [
        ("plain", lines.clone()),
        ("comment", format!("# C:\\models\\\n{lines}# the end \\")),
        ("group", lines.replace("usemtl a", "g C:\\models\\\nusemtl a")),
        ("tabs", lines.replace(' ', "\t")),
        ("blanks", lines.replace(' ', "  \t ").replace('\n', " \n\t")),
        ("mac", lines.replace('\n', "\r")),
        ("windows", lines.replace('\n', "\r\n")),
        ("joined", lines.replace("f 1 2 ", "f 1 2 \\\n").replace("v 1 1 0", "v 1 1\\\r\n0")),
        ("late", format!("{}mtllib m.mtl\n", lines.replace("mtllib m.mtl\n", ""))),
        (
            "between",
            lines.replace("mtllib m.mtl\n", "").replace("usemtl b", "mtllib m.mtl\nusemtl b"),
        ),
        ("comments", lines.replace(" a\n", " a # the first\n").replace("3 4\n", "3 4# four\n")),
        ("library", lines.replace("m.mtl\n", "m.mtl # materials\n")),
    ];
    for (name, obj) in layouts {
        let (found, warnings) = parts_of(name, obj.as_bytes(), mtl);
        assert_eq!((found, warnings), (vec![(RED, 2), (GREEN, 2)], vec![]), "{name}");
    }
    let mtl =
        [b"newmtl a # red\nKd 1\t0  0 # 1\n# \\\n" as &[u8], b"newmtl\tb\r\nKd 0 1 0"].concat();
    assert_eq!(parts_of("mtl", lines.as_bytes(), &mtl), (vec![(RED, 2), (GREEN, 2)], vec![]));
}

/// Several libraries, and file names with blanks, `#` and backslashes, in the system's encoding or
/// another.
#[test]
fn libraries_are_found() {
    let (a, b) =
        (b"newmtl a\nKd 1 0 0\n" as &[u8], b"newmtl a\nKd 0 0 1\nnewmtl b\nKd 0 1 0\n" as &[u8]);
    let rest = format!("{SQUARES}usemtl a\nf 1 2 3 4\nusemtl b\nf 2 5 6 3\n");
    let cases: [(&[u8], &str, &str); 9] = [
        (b"mtllib a.mtl b.mtl", "a.mtl", "b.mtl"),
        (b"mtllib a.mtl\nmtllib b.mtl", "a.mtl", "b.mtl"),
        (b"mtllib a.mtl b.mtl # both", "a.mtl", "b.mtl"),
        (b"mtllib my a.mtl my b.mtl", "my a.mtl", "my b.mtl"),
        (b"mtllib #a.mtl b #2.mtl", "#a.mtl", "b #2.mtl"),
        (b"mtllib .\\sub\\a.mtl sub\\b.mtl", "sub/a.mtl", "sub/b.mtl"),
        (b"mtllib ./a.mtl a.mtl b.mtl", "a.mtl", "b.mtl"),
        (b"mtllib \xe9.mtl b.mtl", "\u{e9}.mtl", "b.mtl"),
        (b"mtllib a b", "a", "b"),
    ];
    for (number, (statement, first, second)) in cases.into_iter().enumerate() {
        let obj = [statement, b"\n", rest.as_bytes()].concat();
        let files = [("m.obj", &obj[..]), (first, a), (second, b)];
        let folder = written(&format!("libraries {number}"), &files);
        assert_eq!(
            parts(&folder, Missing::Error),
            (vec![(RED, 2), (GREEN, 2)], vec![]),
            "case {number}"
        );
    }
    // An OBJ file in Latin-1 and its library in UTF-8 mean the same name.
    let obj = [b"mtllib m.mtl\nusemtl \xe9\n", SQUARES.as_bytes(), b"f 1 2 3 4\n"].concat();
    let found = parts_of("encodings", &obj, "newmtl \u{e9}\nKd 1 0 0\n".as_bytes());
    assert_eq!(found, (vec![(RED, 2)], vec![]));
    // Within one library the first counts too, with a warning.
    let obj = format!("mtllib m.mtl\nusemtl a\n{SQUARES}f 1 2 3 4\n");
    let (found, warnings) =
        parts_of("again", obj.as_bytes(), b"newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n");
    assert_eq!(found, [(RED, 2)]);
    assert!(warnings.len() == 1 && warnings[0].contains("`a` is defined again"), "{warnings:?}");
}

/// A face's material that no library defines is an error, wherever its statement stands. No face is
/// dropped.
#[test]
fn undefined_materials() {
    let obj = format!("mtllib m.mtl\n{SQUARES}usemtl Grey #1\nf 1 2 3\nusemtl Grey #3\nf 1 2 3\n");
    let mtl = b"newmtl Grey #1\nKd 1 0 0\nnewmtl unused\nKd 7 x\nmap_Kd nothing.png\n";
    let folder = written("undefined", &[("m.obj", obj.as_bytes()), ("m.mtl", mtl)]);
    let errors = read(&folder, Missing::Error).unwrap_err().errors;
    assert_eq!(
        differs(&errors, &[(10, 8, "`Grey #3` is not defined | did you mean `Grey #1`?")]),
        None
    );
    let (found, warnings) = parts(&folder, Missing::Warn);
    assert_eq!(found, [(RED, 1), (GRAY, 1)]);
    assert!(warnings.len() == 1 && warnings[0].contains("rendered in gray"), "{warnings:?}");
}

/// `--missing warn` replaces a missing library or image by gray, with a warning that names file and
/// place. A broken file is still an error.
#[test]
fn missing_files() {
    let obj = format!("mtllib gone.mtl m.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\nusemtl b\nf 2 5 6 3\n");
    let mtl = "newmtl b\nKd 0 1 0\nmap_Kd gone.png\n";
    let folder = written("missing", &[("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())]);
    let errors = read(&folder, Missing::Error).unwrap_err().errors;
    let expected = [(1, 8, "--missing warn"), (3, 8, "--missing warn")];
    assert_eq!(differs(&errors, &expected), None);
    let loaded = read(&folder, Missing::Warn).unwrap();
    let expected =
        [(3, 8, "gone.png"), (1, 8, "gone.mtl"), (8, 8, "`a` is not defined | rendered in gray")];
    assert_eq!(differs(&loaded.warnings, &expected), None);
    assert_eq!(parts(&folder, Missing::Warn).0, [(GRAY, 2), (GRAY, 2)]);
    std::fs::write(folder.join("gone.png"), b"no picture").unwrap();
    let errors = read(&folder, Missing::Warn).unwrap_err().errors;
    assert_eq!(differs(&errors, &[(3, 8, "cannot read image")]), None);
}

/// Keys that change a surface in other programs and are not supported give a warning at their line,
/// unless their value has no effect.
#[test]
fn unread_keys() {
    let obj = format!("mtllib m.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\n");
    let keys = [
        "Tr 0.9",
        "Tf 1 0 0",
        "map_Ke x.png",
        "norm x.png",
        "Pr 0.3",
        "Pm 1",
        "refl x.png",
        "disp x.png",
        "map_kd x.png",
        "map_Bump x.png",
        "bump x.png",
        "map_d x.png",
        "d 0.5",
        "aniso 0.5",
        "foo 1",
    ];
    let mtl = format!("newmtl a\nKd 1 0 0\n{}\n", keys.join("\n"));
    let folder = written("keys", &[("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())]);
    let mut warnings = read(&folder, Missing::Error).unwrap().warnings;
    warnings.sort_by_key(|warning| warning.line_column());
    let expected: Vec<_> = (0..keys.len())
        .map(|at| {
            let what = if keys[at].starts_with("foo") { "is not known" } else { "is not" };
            let what = if keys[at].starts_with("map_kd") { "did you mean `map_Kd`?" } else { what };
            (3 + at, 1, what)
        })
        .collect();
    assert_eq!(differs(&warnings, &expected), None);
    let idle = b"newmtl a\nKd 1 0 0\nKa 1 1 1\nKs 0.5 0.5 0.5\nNs 10\nTr 0\nTf 1 1 1\nPm 0.0\n\
                 d 1\nillum 2\n";
    assert_eq!(parts_of("idle", obj.as_bytes(), idle), (vec![(RED, 2)], vec![]));
}

/// Values that are unused, or out of range by rounding only, are accepted; others are errors.
#[test]
fn values_out_of_range() {
    let obj = format!("mtllib m.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\n");
    let of = |name: &str, lines: &str| {
        let mtl = format!("newmtl a\nKd 1 0 0\n{lines}\n");
        written(name, &[("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())])
    };
    for (name, lines, part) in [
        ("ka", "Ka 0", "`Ka` has 1 value, and is not used"),
        ("ks", "Ks 1.5 1.5 1.5", "`1.5` is out of range, and is not used"),
        ("ns", "Ns -1.96", "`-1.96` is out of range, and is not used"),
        ("ni", "Ni nan", "`nan` is not a finite number, and is not used"),
        (
            "kd",
            "Kd 1.000001 -1e-7 0",
            "2 numbers are out of range by rounding, the worst is `1.000001`",
        ),
        ("ke", "Ke -0.0000001 0 0", "`-0.0000001` is out of range by rounding"),
    ] {
        let (found, warnings) = parts(&of(name, lines), Missing::Error);
        assert_eq!(found, [(RED, 2)], "{name}");
        assert!(warnings.len() == 1 && warnings[0].contains(part), "{name}: {warnings:?}");
    }
    assert_eq!(parts(&of("illum", "illum 2.0"), Missing::Error), (vec![(RED, 2)], vec![]));
    for (name, lines, expected) in [
        ("kd 3", "Kd 3 0 0", (3, 4, "from 0 to 1")),
        ("kd 1.01", "Kd 1.01 0 0", (3, 4, "from 0 to 1")),
        ("ind", "Kd 0 -1.#IND 0", (3, 6, "`-1.#IND` is not a finite number, but the result of")),
        ("qnan", "Ke 0 0 1.#QNAN", (3, 8, "`1.#QNAN` is not a finite number")),
        ("comma", "Kd 0,5 0 0", (3, 4, "a point, not a comma")),
        ("illum x", "illum x", (3, 7, "expected a whole number")),
        ("d", "d 3", (3, 3, "from 0 to 1")),
    ] {
        let errors = read(&of(name, lines), Missing::Error).unwrap_err().errors;
        assert_eq!(differs(&errors, &[expected]), None, "{name}");
    }
}

/// OBJ files with vertex colours and unused vertices.
#[test]
fn unused_vertices() {
    let mtl = b"newmtl a\nKd 1 0 0\n";
    let of = |lines: &str| format!("mtllib m.mtl\n{SQUARES}{lines}usemtl a\nf 1 2 3 4\n");
    for (name, lines, part) in [
        ("color", "v 0 0 0 nan nan nan\n", "1 `vertex color` not used"),
        ("rgba", "v 0 0 0 1 1 1 1\n", "1 `vertex color` not used"),
        ("nan", "v 0 -1.#IND 0\nv 1e20 0 0\n", "2 vertices have a number that cannot be used"),
        ("normal", "vn nan nan nan\n", "1 normals have a number"),
        ("uv", "vt 0 nan\n", "1 texture coordinates have a number"),
        ("uvw", "vt 0 0 nan\n", ""),
    ] {
        let (found, warnings) = parts_of(name, of(lines).as_bytes(), mtl);
        assert_eq!(found, [(RED, 2)], "{name}");
        let count = usize::from(!part.is_empty());
        assert!(
            warnings.len() == count && warnings.iter().all(|w| w.contains(part)),
            "{name}: {warnings:?}"
        );
    }
    for (name, lines, face, expected) in [
        (
            "used",
            "v 0 -1.#IND 0\n",
            "f 1 2 7\n",
            (8, 5, "`-1.#IND` is not a finite number, but the result of"),
        ),
        ("ahead", "f 1 2 7\nv 1.#QNAN 0 0\n", "", (9, 3, "`1.#QNAN` is not a finite number")),
        ("behind", "v nan 0 0\n", "f 1 2 -1\n", (8, 3, "`nan` is not a finite number")),
        ("w", "v 1 0 0 0\n", "f 1 2 7\n", (8, 9, "w = 0")),
        (
            "vn",
            "vn 1.#QNAN 0 0\n",
            "f 1//1 2//1 3//1\n",
            (8, 4, "`1.#QNAN` is not a finite number"),
        ),
    ] {
        let obj = format!("usemtl a\n{}", of(lines).replace("usemtl a\n", face))
            .replace("f 1 2 3 4\n", "");
        let obj = obj.replacen("usemtl a\n", "", 1).replacen(
            "mtllib m.mtl\n",
            "usemtl a\nmtllib m.mtl\n",
            1,
        );
        let expected = (expected.0 + 1, expected.1, expected.2);
        let folder = written(name, &[("m.obj", obj.as_bytes()), ("m.mtl", mtl)]);
        let errors = read(&folder, Missing::Error).unwrap_err().errors;
        assert_eq!(differs(&errors, &[expected]), None, "{name}:\n{obj}");
    }
}

/// Images in `map_Kd`: names with `#`, blanks and backslashes, and comments.
#[test]
fn pictures_of_materials() {
    let obj = format!("mtllib m.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\n");
    for (number, (name, file)) in [
        ("tex\\t.png", "tex/t.png"),
        ("t #1.png", "t #1.png"),
        ("my t.png # wood", "my t.png"),
        ("t#1.png", "t#1.png"),
    ]
    .into_iter()
    .enumerate()
    {
        let mtl = format!("newmtl a\nmap_Kd {name}\n");
        let files = [("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes()), (file, b"")];
        let folder = written(&format!("pictures {number}"), &files);
        image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7])).save(folder.join(file)).unwrap();
        let loaded = read(&folder, Missing::Error).unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!((loaded.scene.images.len(), loaded.warnings.len()), (1, 0), "{name}");
    }
}

/// Every command that reads a scene accepts the option, and the error names it.
#[test]
fn missing_files_of_commands() {
    let obj = format!("mtllib gone.mtl\n{SQUARES}usemtl a\nf 1 2 3 4\n");
    let scene = format!(
        "{HEAD}[film]\nwidth = 8\nheight = 6\n[environment]\nradiance = 1\n[[shapes]]\n\
         type = \"mesh\"\n\
         file = \"m.obj\"\n"
    );
    let folder = written("commands", &[("m.obj", obj.as_bytes()), ("s.toml", scene.as_bytes())]);
    let commands: [&[&str]; 3] =
        [&["check"], &["info"], &["render", "--device", "cpu", "--passes", "1", "-o", "out.pfm"]];
    for command in commands {
        let with = |more: &[&'static str]| [command, &["s.toml"], more].concat();
        ends(&folder, &with(&[]), 1, &["gone.mtl", "m.obj:1:8", "--missing warn"]);
        ends(&folder, &with(&["--missing", "error"]), 1, &["gone.mtl"]);
        let words = ["gone.mtl", "m.obj:1:8", "`a` is not defined", "rendered in gray"];
        ends(&folder, &with(&["--missing", "warn"]), 0, &words);
    }
    ends(&folder, &["check", "s.toml", "--missing", "ignore"], 2, &["error, warn"]);
}

/// Lines that end in carriage returns only are not TOML, and one error says so.
#[test]
fn carriage_returns_of_a_scene() {
    let text = HEAD.replace('\n', "\r");
    let errors = caustica::low_level::scene::parse("scene.toml".as_ref(), text.as_bytes())
        .unwrap_err()
        .errors;
    assert_eq!(differs(&errors, &[(1, 12, "carriage returns alone")]), None);
}
