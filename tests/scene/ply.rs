//! PLY meshes: encodings, layouts of elements, and errors.
//!
//! Theory: a file is a table of numbers. Its encoding, the types of its numbers, the order of its
//! elements and elements other than the mesh do not change the mesh, which equals that of an OBJ
//! file with the same numbers. A file that promises more than it has is refused before memory is
//! allocated.

use std::fs;
use std::path::Path;

use caustica::low_level::scene::{Allowance, Mesh, SceneErrors, ShapeKind, parse_within};

use crate::support::{HEAD, folder};

/// A value of a row.
#[derive(Clone, Debug)]
enum Value {
    One(f64),
    Many(Vec<f64>),
}
use Value::{Many, One};

/// An element: name, properties as in the header, rows.
type Table = (&'static str, Vec<&'static str>, Vec<Vec<Value>>);

/// A file in one of the three formats.
fn encoded(format: &str, tables: &[Table], line_end: &str) -> Vec<u8> {
    let mut header = format!("ply\nformat {format} 1.0\ncomment by hand\n");
    for (name, properties, rows) in tables {
        header += &format!("element {name} {}\n", rows.len());
        header.extend(properties.iter().map(|property| format!("property {property}\n")));
    }
    let mut file = (header + "end_header\n").replace('\n', line_end).into_bytes();
    for (_, properties, rows) in tables {
        for row in rows {
            let mut words = Vec::new();
            for (property, value) in properties.iter().zip(row) {
                let types: Vec<_> = property.split(' ').collect();
                let mut put = |kind: &str, number: f64| {
                    words.push(number.to_string());
                    file.extend(bytes(format, kind, number));
                };
                match value {
                    One(number) => put(types[0], *number),
                    Many(numbers) => {
                        put(types[1], numbers.len() as f64);
                        numbers.iter().for_each(|number| put(types[2], *number));
                    }
                }
            }
            if format == "ascii" {
                file.extend(words.join(" ").bytes().chain(line_end.bytes()));
            }
        }
    }
    file
}

fn bytes(format: &str, kind: &str, number: f64) -> Vec<u8> {
    let mut bytes = match kind {
        "char" | "int8" => (number as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" => (number as u8).to_le_bytes().to_vec(),
        "short" | "int16" => (number as i16).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (number as u16).to_le_bytes().to_vec(),
        "int" | "int32" => (number as i32).to_le_bytes().to_vec(),
        "uint" | "uint32" => (number as u32).to_le_bytes().to_vec(),
        "float" | "float32" => (number as f32).to_le_bytes().to_vec(),
        "double" | "float64" => number.to_le_bytes().to_vec(),
        _ => panic!("{kind}"),
    };
    match format {
        "ascii" => Vec::new(),
        "binary_big_endian" => {
            bytes.reverse();
            bytes
        }
        _ => bytes,
    }
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

fn rows(rows: &[&[f64]]) -> Vec<Vec<Value>> {
    rows.iter().map(|row| row.iter().map(|number| One(*number)).collect()).collect()
}

/// An L of six corners, a triangle and a quadrilateral above it, with normals and texture
/// coordinates.
fn mesh_tables() -> Vec<Table> {
    let points = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, 2.0],
        [0.0, 0.0, 2.0],
        [0.5, 1.5, -0.25],
    ];
    let vertex: Vec<Vec<Value>> = points
        .iter()
        .map(|[x, y, z]| [*x, *y, *z, 0.0, -1.0, 0.125 * x, 0.5 * x, 0.25 * z].map(One).to_vec())
        .collect();
    let faces = [vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0], vec![0.0, 6.0, 1.0], vec![1.0, 6.0, 3.0, 2.0]];
    let names = ["x", "y", "z", "nx", "ny", "nz", "s", "t"];
    let properties =
        ["float x", "float y", "float z", "float nx", "float ny", "float nz", "float s", "float t"];
    assert_eq!(properties.map(|property| property.trim_start_matches("float ")), names);
    vec![
        ("vertex", properties.to_vec(), vertex),
        (
            "face",
            vec!["list uchar int vertex_indices"],
            faces.into_iter().map(|face| vec![Many(face)]).collect(),
        ),
    ]
}

/// The same mesh as an OBJ file.
fn obj() -> String {
    let tables = mesh_tables();
    let mut text = String::new();
    for row in &tables[0].2 {
        let n: Vec<f64> = row
            .iter()
            .map(|value| match value {
                One(number) => *number,
                Many(_) => panic!("a list"),
            })
            .collect();
        text += &format!(
            "v {} {} {}\nvn {} {} {}\nvt {} {}\n",
            n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]
        );
    }
    for row in &tables[1].2 {
        let Many(face) = &row[0] else { panic!("a number") };
        text += "f";
        text.extend(face.iter().map(|index| format!(" {0}/{0}/{0}", index + 1.0)));
        text += "\n";
    }
    text
}

fn load(folder: &Path, file: &str, more: &str) -> Result<(Mesh, Vec<String>), SceneErrors> {
    let text = format!(
        "{HEAD}[environment]\nradiance = 1\n[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"mesh\"\nfile = {file:?}\n{more}"
    );
    let loaded = parse_within(&folder.join("scene.toml"), text.as_bytes(), &Allowance::default())?;
    let ShapeKind::Mesh(mesh) = &loaded.scene.shapes[0].kind else { panic!("no mesh") };
    let warnings = loaded.warnings.iter().map(|warning| warning.message().to_owned());
    Ok((mesh.clone(), warnings.collect()))
}

const MATERIAL: &str = "material = \"m\"\n";

fn mesh(name: &str, ply: &[u8]) -> Mesh {
    let folder = folder(name);
    fs::write(folder.join("m.ply"), ply).unwrap();
    let (mesh, warnings) = load(&folder, "m.ply", MATERIAL).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(warnings, [""; 0], "{name}");
    mesh
}

/// All encodings and line ends, and the OBJ file; smooth and flat, moved and not.
#[test]
fn encodings_agree() {
    let folder = folder("encodings");
    fs::write(folder.join("m.obj"), obj()).unwrap();
    let moved = "transform = { scale = 2.0, translate = [1, 2, 3] }\n";
    for more in ["", "smooth = false\n", moved] {
        let more = MATERIAL.to_owned() + more;
        let (expected, _) = load(&folder, "m.obj", &more).unwrap();
        assert_eq!(expected.triangles.len(), 4 + 1 + 2);
        assert!(expected.triangles.iter().all(|triangle| triangle.uv.is_some()));
        for format in FORMATS {
            for line_end in ["\n", "\r\n", "\r"] {
                fs::write(folder.join("M.PLY"), encoded(format, &mesh_tables(), line_end)).unwrap();
                let (found, warnings) = load(&folder, "M.PLY", &more).unwrap();
                assert_eq!(found, expected, "{format} {line_end:?}");
                assert_eq!(warnings, [""; 0]);
            }
        }
    }
}

/// Without normals, they are computed as for OBJ files.
#[test]
fn normals_are_computed() {
    let folder = folder("computed");
    let mut tables = mesh_tables();
    tables[0].1.drain(3..6);
    tables[0].2.iter_mut().for_each(|row| drop(row.drain(3..6)));
    fs::write(folder.join("m.ply"), encoded("binary_big_endian", &tables, "\n")).unwrap();
    let lines = obj();
    let lines = lines.lines().filter(|line| !line.starts_with("vn"));
    let plain: String = lines.map(|line| line.to_owned() + "\n").collect();
    let plain: String =
        (1..=7).fold(plain, |text, n| text.replace(&format!("{n}/{n}/{n}"), &format!("{n}/{n}")));
    fs::write(folder.join("m.obj"), plain).unwrap();
    let [(ply, _), (obj, _)] =
        ["m.ply", "m.obj"].map(|file| load(&folder, file, MATERIAL).unwrap());
    assert!(ply.triangles.iter().all(|triangle| triangle.normal.is_some()));
    assert_eq!(ply, obj);
}

/// Lists of all types, in files of all encodings, and scalars of all types.
#[test]
fn types_are_read() {
    let expected = mesh("types", &encoded("ascii", &mesh_tables(), "\n"));
    let integers = ["char", "uchar", "short", "ushort", "int", "uint"];
    let others = ["int8", "uint8", "int16", "uint16", "int32", "uint32"];
    for (count, index) in integers.iter().flat_map(|a| others.iter().map(move |b| (a, b))) {
        let mut tables = mesh_tables();
        tables[1].1 =
            vec![Box::leak(format!("list {count} {index} vertex_index").into_boxed_str())];
        for format in FORMATS {
            let found = mesh("types", &encoded(format, &tables, "\n"));
            assert_eq!(found, expected, "{format} {count} {index}");
        }
    }
    let mut tables = mesh_tables();
    tables[0].1[..3].copy_from_slice(&["float64 x", "double y", "float32 z"]);
    for (at, names) in
        [["float u", "float v"], ["double texture_u", "float texture_v"]].iter().enumerate()
    {
        tables[0].1[6..].copy_from_slice(names);
        assert_eq!(mesh("types", &encoded(FORMATS[at + 1], &tables, "\n")), expected);
    }
}

/// Elements and properties that are not used stand before, between and behind the others.
#[test]
fn others_are_skipped() {
    let expected = mesh("others", &encoded("ascii", &mesh_tables(), "\n"));
    let mut tables = mesh_tables();
    let [vertex, face] = &mut tables[..] else { panic!() };
    vertex.1.insert(2, "list short double x_list");
    vertex.1.push("uchar quality");
    for (at, row) in vertex.2.iter_mut().enumerate() {
        row.insert(2, Many(vec![0.5; at]));
        row.push(One(200.0));
    }
    face.1.insert(0, "int flags");
    face.1.push("list uint char names");
    for row in &mut face.2 {
        row.insert(0, One(-5.0));
        row.push(Many(vec![-1.0, 3.0]));
    }
    tables
        .insert(1, ("edge", vec!["int vertex1", "int vertex2"], rows(&[&[0.0, 1.0], &[1.0, 2.0]])));
    tables.insert(0, ("camera", vec!["float view_px"], rows(&[&[1.0]])));
    tables.push(("nothing", vec![], vec![vec![]; 3]));
    for format in FORMATS {
        let file = encoded(format, &tables, "\n");
        let file = String::from_utf8(file.clone()).map_or(file, |text| {
            // A row without properties is an empty line, and there may be any number of them.
            text.replace("comment by hand", "obj_info a b\ncomment by hand").into_bytes()
        });
        assert_eq!(mesh("others", &file), expected, "{format}");
    }
    // Faces may stand before the vertices.
    let mut tables = mesh_tables();
    tables.reverse();
    FORMATS.iter().for_each(|format| {
        assert_eq!(mesh("others", &encoded(format, &tables, "\n")), expected, "{format}");
    });
}

/// Texture coordinates of the corners of faces replace those of vertices; an empty list keeps them.
#[test]
fn corners_have_texture_coordinates() {
    let mut tables = mesh_tables();
    tables[1].1.push("list uchar float texcoord");
    let given = [vec![], vec![0.0, 0.5, 0.25, 0.75, 1.0, 0.125], vec![]];
    for (row, given) in tables[1].2.iter_mut().zip(given) {
        row.push(Many(given));
    }
    for format in FORMATS {
        let mesh = mesh("corners", &encoded(format, &tables, "\n"));
        let uv = |triangle: usize| {
            mesh.triangles[triangle].uv.unwrap().map(|at| mesh.uvs[at as usize].to_array())
        };
        assert_eq!(uv(4), [[0.0, 0.5], [0.25, 0.75], [1.0, 0.125]]);
        assert!(uv(5).iter().all(|[_, v]| *v <= 0.25));
    }
}

fn errors(name: &str, ply: &[u8], more: &str) -> Vec<String> {
    let folder = folder(name);
    fs::write(folder.join("m.ply"), ply).unwrap();
    let Err(errors) = load(&folder, "m.ply", more) else {
        panic!("no error in\n{}", String::from_utf8_lossy(ply))
    };
    let shown = |error: &caustica::low_level::scene::Finding| {
        let (line, column) = error.line_column().unwrap();
        format!("{line}:{column} {} | {}", error.message(), error.label())
    };
    errors.errors.iter().map(shown).collect()
}

const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

/// One fault each in [`SQUARE`]: the text, what replaces it, and the error with its line.
#[test]
fn faults_are_located() {
    let cases = [
        ("ply\n", "plyx\n", "1:1 not a PLY file | expected `ply` in the first line"),
        ("format ascii 1.0\n", "", "8:1 no `format` | expected `format ascii"),
        ("ascii 1.0", "ascii 2.0", "2:1 an unknown format | expected ascii, binary_little"),
        ("ascii 1.0", "ascii 1.0\nformat ascii 1.0", "3:1 a second `format`"),
        ("vertex 4", "vertex four", "3:1 `four` is not a number of rows"),
        ("vertex 4", "vertex -4", "3:1 `-4` is not a number of rows"),
        ("vertex 4", "vertex", "3:1 not an element | expected `element NAME COUNT`"),
        ("element face", "element vertex", "7:1 a second element `vertex`"),
        ("element vertex 4\n", "", "3:1 a property without an element"),
        ("float y", "float x", "5:1 a second property `x`"),
        ("float y", "half y", "5:1 `half` is no type of numbers | expected char, uchar"),
        ("float y", "float", "5:1 not a property"),
        ("float y", "float why", "3:1 `vertex` has no `y` that is a number"),
        ("float y", "list uchar float y", "3:1 `vertex` has no `y` that is a number"),
        ("list uchar int", "list float int", "8:1 the length of a list is not an integer"),
        ("list uchar int", "list uchar float", "7:1 `face` has no list of whole numbers"),
        ("vertex_indices", "points", "7:1 `face` has no list of whole numbers"),
        ("element face", "elements face", "7:1 `elements` is no line of a PLY header"),
        ("element face 1\nproperty list uchar int vertex_indices\n", "", "no element `face`"),
        ("end_header\n", "", "9:1 `0` is no line of a PLY header"),
        ("1 1 0", "1 one 0", "12:3 `one` is not a number | expected `y` of an element `vertex`"),
        ("1 1 0", "1 nan 0", "12:3 `y` is not a finite number"),
        ("1 1 0", "1 1 1e16", "12:5 `z` = 1e16 is too large for single precision"),
        ("1 1 0", "1 1", "13:3 a row with more or fewer numbers than the header states"),
        ("1 1 0", "1 1 0 0", "12:7 a row with more or fewer numbers than the header states"),
        ("4 0 1 2 3", "4 0 1 2 4", "14:9 4 is no index of a vertex | expected 0 to 3"),
        ("4 0 1 2 3", "4 0 1 -2 3", "14:7 -2 is no index of a vertex"),
        ("4 0 1 2 3", "4 0 1 2.5 3", "14:7 2.5 is no index of a vertex"),
        ("4 0 1 2 3", "2 0 1", "14:1 a face of 2 corners | expected at least 3"),
        ("4 0 1 2 3", "-1 0 1", "14:1 a list of -1 numbers"),
        ("4 0 1 2 3", "4e9 0 1", "14:1 a list of 4000000000 numbers, more than the file has"),
        ("4 0 1 2 3", "4 0 1 2", "7:1 the file ends at byte 186, before the end of `face`"),
        ("face 1", "face 2", "7:1 the file ends at byte 188, before the end of `face`"),
        ("vertex 4", "vertex 9000000000", "3:1 the file ends at byte"),
        ("vertex 4", "vertex 18446744073709551615", "3:1 the file ends at byte"),
        ("face 1", "face 0", "m.ply has no triangles"),
    ];
    assert!(
        errors("faults", SQUARE.as_bytes(), "")[0].contains("has no material: PLY files have none")
    );
    let mut wrong = Vec::new();
    for (from, to, expected) in cases {
        assert_eq!(SQUARE.matches(from).count(), 1, "{from}");
        let found = errors("faults", SQUARE.replace(from, to).as_bytes(), MATERIAL);
        if found.len() != 1 || !found[0].contains(expected) {
            wrong.push(format!("{to}: {found:?}, {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // All wrong indices are reported at once, and unused vertices cause a warning.
    let found = errors("faults", SQUARE.replace("0 1 2 3", "7 8 9 3").as_bytes(), MATERIAL);
    assert_eq!(found.len(), 3, "{found:?}");
    let folder = folder("unused");
    let unused = SQUARE.replace("4 0 1 2 3", "3 0 1 2").replace("0 1 0\n", "0 inf 0\n");
    fs::write(folder.join("m.ply"), unused + "0 0\n").unwrap();
    let (_, warnings) = load(&folder, "m.ply", MATERIAL).unwrap();
    assert!(warnings[0].contains("1 vertex has a number that cannot be used"), "{warnings:?}");
    assert!(warnings[1].contains("bytes after the last element not used"), "{warnings:?}");
}

/// Binary files: the line of the header, and the byte.
#[test]
fn faults_in_binary_files_are_located() {
    let tables = mesh_tables();
    for format in ["binary_little_endian", "binary_big_endian"] {
        let good = encoded(format, &tables, "\n");
        let body = good.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
        // Cut anywhere: the file is too short, and never another error.
        for length in body..good.len() {
            let found = errors("cut", &good[..length], MATERIAL);
            let expected = format!("the file ends at byte {length}, before the end of");
            let list = "numbers, more than the file has";
            assert!(found[0].contains(&expected) || found[0].contains(list), "{found:?}");
        }
        let faces = body + 7 * 32;
        let mut bad = good.clone();
        bad[faces] = 0xff;
        let found = errors("cut", &bad, MATERIAL);
        assert!(found[0].contains("a list of 255 numbers"), "{found:?}");
        let mut bad = good.clone();
        bad[faces + 1..faces + 5].fill(0xff);
        let found = errors("cut", &bad, MATERIAL);
        let expected = format!("-1 is no index of a vertex, at byte {}", faces + 1);
        assert!(found[0].starts_with("14:1") && found[0].contains(&expected), "{found:?}");
        let mut bad = good.clone();
        bad[body..body + 4].fill(0xff);
        let found = errors("cut", &bad, MATERIAL);
        let expected = format!("`x` is not a finite number, at byte {body}");
        assert!(found[0].starts_with("5:1") && found[0].contains(&expected), "{found:?}");
    }
}

/// Limits apply before the mesh is built.
#[test]
fn limits_apply() {
    let folder = folder("limits");
    fs::write(folder.join("m.ply"), SQUARE).unwrap();
    let text = format!(
        "{HEAD}[environment]\nradiance = 1\n[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"mesh\"\nfile = \"m.ply\"\nmaterial = \"m\"\n"
    );
    for (name, exact) in
        [("mesh-bytes", SQUARE.len() as u64), ("mesh-triangles", 2), ("triangles", 2)]
    {
        let load = |value: u64| {
            let mut allowance = Allowance::default();
            *allowance.limit(name).unwrap() = value;
            parse_within(&folder.join("scene.toml"), text.as_bytes(), &allowance)
        };
        assert!(load(exact).is_ok(), "{name}");
        let errors = load(exact - 1).err().unwrap();
        let help = errors.errors[0].help().unwrap().to_owned();
        assert!(help.contains(&format!("--limit {name}=N")), "{help}");
    }
}
