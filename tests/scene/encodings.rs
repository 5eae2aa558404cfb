//! Text encodings of other systems: Windows line ends, the UTF-8 byte order mark, UTF-16.
//!
//! Theory: neither line ends nor the mark are content. A scene has the same content in either
//! encoding, and an error has the same line, column and words. Text in UTF-16 or UTF-32 is reported
//! as such, with the file name.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{self, repository, sound};
use caustica::low_level::render::identity::Identity;
use caustica::low_level::scene::{Finding, load, load_profile};

const SCENE: &str = r#"version = 1 # a drop on a mesh
[camera]
position = [0.0, 1.0, 4.0]
target = [0.0, 0.5, 0.0]
fov = 40.0
[materials.white]
type = "diffuse"
reflectance = [
  0.8,
  0.7, 0.6,
]
[[shapes]]
type = "mesh"
file = "parts.obj"
[[shapes]]
type = "mesh"
file = "cube.obj"
material = "white"
[[shapes]]
type = "revolution"
profile = [[0.0, 2.0], [0.5, 2.0], [0.0, 3.0]]
material = "white"
"#;

/// A scene with errors in the scene file, the mesh and its materials.
const BROKEN: &str = r#"version = 1
[camera]
position = [0.0, 1.0, 4.0]
target = [0.0, 1.0, 0.0]
fov = 400.0
up = [
  0, 0,
  "é", 1 ]
[[shapes]]
type = "mesh"
file = "broken.obj"
"#;

type Write = fn(&str) -> Vec<u8>;

/// Encodings of the same content.
const SAME: [(&str, Write); 4] = [
    ("unix", |text| text.as_bytes().to_vec()),
    ("windows", |text| text.replace('\n', "\r\n").into_bytes()),
    ("marked", |text| format!("\u{feff}{text}").into_bytes()),
    ("windows, marked", |text| format!("\u{feff}{}", text.replace('\n', "\r\n")).into_bytes()),
];

const FOREIGN: [(&str, Write); 3] = [
    ("UTF-16", |text| {
        format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect()
    }),
    ("UTF-16", |text| text.encode_utf16().flat_map(u16::to_be_bytes).collect()),
    ("UTF-32", |text| {
        format!("\u{feff}{text}").chars().flat_map(|c| u32::from(c).to_le_bytes()).collect()
    }),
];

/// A fresh folder with the files that scenes refer to, in UTF-8 with Unix line ends.
fn folder(name: &str) -> PathBuf {
    let folder = support::folder(name);
    fs::create_dir(folder.join("reference")).unwrap();
    let data = repository("tests/data");
    fs::copy(data.join("reference/grid.png"), folder.join("reference/grid.png")).unwrap();
    for name in ["parts.obj", "parts.mtl", "cube.obj", "broken.obj", "broken.mtl"] {
        fs::copy(data.join(name), folder.join(name)).unwrap();
    }
    folder
}

/// Rewrites files of the folder in another encoding.
fn rewrite(folder: &Path, names: &[&str], write: Write) {
    for name in names {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        fs::write(folder.join(name), write(&text)).unwrap();
    }
}

fn identity(file: &Path) -> Identity {
    let loaded = sound(load(file));
    Identity::of(&loaded.scene)
}

#[test]
fn the_same_scene() {
    let of = |name: &str, write: Write, text: &str| {
        let folder = folder(&format!("same {name}"));
        rewrite(&folder, &["parts.obj", "parts.mtl", "cube.obj"], write);
        fs::write(folder.join("scene.toml"), write(text)).unwrap();
        identity(&folder.join("scene.toml"))
    };
    let (plain, write) = SAME[0];
    let expected = of(plain, write, SCENE);
    for (name, write) in SAME {
        assert_eq!(of(name, write, SCENE), expected, "{name}");
    }
    let planted = of("planted", write, &SCENE.replace("2.0], [0.5", "2.0], [0.5000001"));
    assert_ne!(planted, expected, "another profile has another identity");
}

/// Line and column, message, label.
type Reported = (Option<(usize, usize)>, String, String);

fn reported(errors: &[Finding]) -> Vec<Reported> {
    errors.iter().map(|e| (e.line_column(), e.message().to_owned(), e.label().to_owned())).collect()
}

#[test]
fn the_same_errors() {
    let of = |text: &str, write: Write| {
        let folder = folder("errors");
        rewrite(&folder, &["broken.obj", "broken.mtl"], write);
        fs::write(folder.join("scene.toml"), write(text)).unwrap();
        reported(&load(&folder.join("scene.toml")).unwrap_err().errors)
    };
    let unfinished = "version = 1\n[camera]\nposition = [0, 1\n";
    for (text, least) in [(BROKEN, 12), (unfinished, 1)] {
        let expected = of(text, SAME[0].1);
        assert!(
            expected.len() >= least && expected.iter().all(|(place, ..)| place.is_some()),
            "{expected:?}"
        );
        for (name, write) in SAME {
            assert_eq!(of(text, write), expected, "{name}");
        }
        assert_ne!(of(&format!("\n{text}"), SAME[0].1), expected, "a line more moves the places");
    }
}

#[test]
fn the_same_profile() {
    let folder = folder("profile");
    let file = folder.join("p.toml");
    let text = "profile = [\n  [0.0, 0.0], [0.5, 0.0],\n  [0.0, 1.0]]\n";
    let of = |text: &str, write: Write| {
        fs::write(&file, write(text)).unwrap();
        load_profile(&file)
    };
    let segments = of(text, SAME[0].1).unwrap().segments;
    let wrong = text.replace("[0.5", "[-0.5");
    let errors = reported(&of(&wrong, SAME[0].1).unwrap_err().errors);
    assert_eq!(errors[0].0.map(|(line, _)| line), Some(2));
    for (name, write) in SAME {
        assert_eq!(of(text, write).unwrap().segments, segments, "{name}");
        assert_eq!(reported(&of(&wrong, write).unwrap_err().errors), errors, "{name}");
    }
}

#[test]
fn other_encodings_are_told() {
    for (encoding, write) in FOREIGN {
        for name in ["scene.toml", "parts.obj", "parts.mtl"] {
            let folder = folder(&format!("{encoding} {name}"));
            fs::write(folder.join("scene.toml"), SCENE).unwrap();
            rewrite(&folder, &[name], write);
            let errors = load(&folder.join("scene.toml")).unwrap_err().errors;
            let error = &errors[0];
            for word in [name, encoding, "expected UTF-8"] {
                assert!(error.message().contains(word), "{encoding} {name}: {error:?}");
            }
            let mend = format!("{} {}", error.label(), error.help().unwrap_or(""));
            assert!(mend.contains("save it as UTF-8"), "{encoding} {name}: {error:?}");
        }
        let folder = folder("foreign profile");
        fs::write(folder.join("p.toml"), write("profile = [[0, 0], [1, 1]]\n")).unwrap();
        let errors = load_profile(&folder.join("p.toml")).unwrap_err().errors;
        assert!(errors[0].message().contains(encoding), "{errors:?}");
    }
}
