//! Random bytes in files.

use caustica::low_level::scene::parse;

use crate::support::{HEAD, data, folder};

/// A file of any bytes loads or is refused. Nothing panics, and every error has a place in the
/// text.
#[test]
fn mutated_files() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |below: usize| {
        // xorshift64 (Marsaglia 2003)
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 16) as usize % below
    };
    let mut refused = 0;
    for name in ["reference/cornell.toml", "reference/drop.toml", "reference/mesh.toml"] {
        let original = std::fs::read(data(name)).unwrap();
        for _ in 0..100 {
            let mut bytes = original.clone();
            for _ in 0..1 + random(3) {
                let at = random(bytes.len());
                match random(4) {
                    0 => bytes[at] = random(256) as u8,
                    1 => drop(bytes.remove(at)),
                    2 => bytes.insert(at, b"[]{}=\",.-0123456789\n#e"[random(22)]),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            if let Err(errors) = parse(&data(name), &bytes) {
                refused += 1;
                assert!(!errors.errors.is_empty());
                assert!(
                    errors.errors.iter().all(|error| error.line_column().is_some()),
                    "{errors:?}"
                );
            }
        }
    }
    assert!(refused > 100, "the mutations do not bite: {refused}");
}

/// OBJ and MTL files of any bytes load or are refused. Nothing panics (tobj alone does).
#[test]
fn mutated_meshes() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 16) as usize % below
    };
    let folder = folder("mutated");
    std::fs::create_dir(folder.join("reference")).unwrap();
    std::fs::copy(data("reference/grid.png"), folder.join("reference/grid.png")).unwrap();
    let text = format!("{HEAD}[[shapes]]\ntype = \"mesh\"\nfile = \"parts.obj\"\n");
    let mut refused = 0;
    for _ in 0..400 {
        for name in ["parts.obj", "parts.mtl"] {
            let mut bytes = std::fs::read(data(name)).unwrap();
            for _ in 0..random(4) {
                let at = random(bytes.len());
                match random(3) {
                    0 => bytes[at] = random(256) as u8,
                    1 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, b" /-.0123456789\n#fvn\\"[random(20)]),
                }
            }
            std::fs::write(folder.join(name), bytes).unwrap();
        }
        refused += usize::from(parse(&folder.join("scene.toml"), text.as_bytes()).is_err());
    }
    assert!((50..400).contains(&refused), "{refused}");
}
