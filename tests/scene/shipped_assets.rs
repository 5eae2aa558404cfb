//! The shipped meshes and textures equal the generator's output, and they are well formed.

use crate::assets::mesh::Mesh;
use crate::assets::{self, Content};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::path::Path;
use std::sync::LazyLock;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets");

/// All assets, generated once for all tests.
static MADE: LazyLock<Vec<assets::Asset>> = LazyLock::new(assets::all);

/// Largest size of one file, in bytes.
const SIZE_LIMIT: u64 = 1 << 20;

/// Lists the faults of `mesh`. Its first `closed` triangles must bound a solid.
fn faults(mesh: &Mesh, closed: usize) -> Vec<String> {
    let mut faults = Vec::new();
    let count = mesh.positions.len();
    if mesh.normals.len() != count || mesh.uvs.len() != count {
        faults.push("not one normal and uv per vertex".into());
    }
    for n in &mesh.normals {
        if (n.length() - 1.0).abs() > 1e-9 {
            faults.push(format!("normal {n} is not unit"));
        }
    }
    for (k, t) in mesh.triangles.iter().enumerate() {
        if t.iter().any(|&i| i >= count) {
            faults.push(format!("triangle {k} has an index beyond {count}"));
            continue;
        }
        let [a, b, c] = t.map(|i| mesh.positions[i]);
        let face = (b - a).cross(c - a);
        if face.length() < 1e-9 {
            faults.push(format!("triangle {k} has no area"));
        }
        // a face that faces away from all its normals is wound the wrong way
        if t.iter().all(|&i| mesh.normals[i].dot(face) < 0.0) {
            faults.push(format!("triangle {k} at {a} faces away from its normals"));
        }
    }
    // A surface bounds a solid if each edge, as a pair of positions, is used equally often in both
    // directions.
    let place = |i: usize| (mesh.positions[i] * 1e5).to_array().map(|x| x.round() as i64);
    let mut edges: HashMap<_, i64> = HashMap::new();
    for t in mesh.triangles.iter().take(closed).filter(|t| t.iter().all(|&i| i < count)) {
        for k in 0..3 {
            let (a, b) = (place(t[k]), place(t[(k + 1) % 3]));
            if a != b {
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
    }
    let open = edges.values().filter(|&&n| n != 0).count();
    if open > 0 {
        faults.push(format!("{open} open edges"));
    }
    faults
}

/// Six times the volume inside the first `closed` triangles, by the divergence theorem; positive if
/// they wind counter-clockwise seen from outside.
fn volume(mesh: &Mesh, closed: usize) -> f64 {
    let part = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i]);
        a.dot(b.cross(c)) / 6.0
    };
    mesh.triangles.iter().take(closed).map(part).sum()
}

/// Describes a difference: the number of differing bytes, or the lengths.
fn difference(made: &[u8], shipped: &[u8]) -> Option<String> {
    if made.len() != shipped.len() {
        return Some(format!("{} bytes made, {} shipped", made.len(), shipped.len()));
    }
    let count = made.iter().zip(shipped).filter(|(a, b)| a != b).count();
    (count > 0).then(|| format!("{count} bytes differ"))
}

/// Every file equals the generator's output: text byte for byte, images value for value
/// (compression may change with the encoder's version).
#[test]
fn shipped_assets_are_current() {
    let mut wrong = Vec::new();
    for asset in MADE.iter() {
        let shipped = std::fs::read(Path::new(FOLDER).join(asset.name)).expect(asset.name);
        let differs = match &asset.content {
            Content::Text(text) => difference(text.as_bytes(), &shipped),
            Content::Picture(canvas) => {
                let image = image::load_from_memory(&shipped).expect(asset.name).to_rgb8();
                assert_eq!((canvas.width, canvas.height), image.dimensions(), "{}", asset.name);
                difference(&canvas.to_rgb8(), image.as_raw())
            }
            Content::Radiance(..) => {
                let decode =
                    |bytes: &[u8]| image::load_from_memory(bytes).expect(asset.name).to_rgb32f();
                let made = decode(&asset.content.to_bytes().expect(asset.name));
                (made != decode(&shipped)).then(|| "radiance differs".into())
            }
        };
        wrong.extend(differs.map(|d| format!("{}: {d}", asset.name)));
    }
    assert!(
        wrong.is_empty(),
        "run `cargo run --release --example make_assets`:\n{}",
        wrong.join("\n")
    );
    assert!(difference(b"one", b"two").is_some() && difference(b"one", b"on").is_some());
}

/// Every file has a generator, and none is larger than the limit.
#[test]
fn every_file_has_a_maker_and_is_small() {
    let made: Vec<_> = MADE.iter().map(|asset| asset.name).collect();
    for entry in std::fs::read_dir(FOLDER).expect("assets/") {
        let entry = entry.expect("assets/");
        let name = entry.file_name().into_string().expect("a name in UTF-8");
        assert!(made.contains(&name.as_str()), "{name} is not made by the generator");
        let size = entry.metadata().expect("its size").len();
        assert!(size < SIZE_LIMIT, "{name} has {size} bytes");
    }
}

/// Meshes are well formed, and the car's body is a closed solid of a small car's volume.
#[test]
fn meshes_are_well_formed() {
    for named in assets::meshes() {
        let mesh = &named.mesh;
        println!(
            "{}: {} vertices, {} triangles",
            named.name,
            mesh.positions.len(),
            mesh.triangles.len()
        );
        assert_eq!(faults(mesh, 0), Vec::<String>::new(), "{}", named.name);
        if named.name == "car.obj" {
            let body = assets::car::body(&assets::car_shape::Unwrapping::new()).triangles.len();
            assert_eq!(faults(mesh, body), Vec::<String>::new());
            // 4 m by 1.55 m by 1.4 m, rounded: between a third and two thirds of its box
            let volume = volume(mesh, body);
            assert!((2.9..5.8).contains(&volume), "{volume} cubic metres");
        }
        if named.library.is_none() {
            // an atlas does not repeat
            let inside = |uv: &DVec2| uv.clamp(DVec2::ZERO, DVec2::ONE) == *uv;
            assert!(mesh.uvs.iter().all(inside), "{}: uv outside [0, 1]", named.name);
        }
    }
}

/// Every material that the house uses is in its library, and the reverse.
#[test]
fn house_materials_match() {
    let library = assets::house::materials();
    let house = assets::house::house();
    let known: Vec<&str> =
        library.lines().filter_map(|line| line.strip_prefix("newmtl ")).collect();
    for (material, _) in &house.groups {
        assert!(known.contains(material), "{material} is not in house.mtl");
    }
    for name in known {
        assert!(house.groups.iter().any(|group| group.0 == name), "{name} is not used");
    }
    for texture in library.lines().filter_map(|line| line.strip_prefix("map_Kd ")) {
        assert!(Path::new(FOLDER).join(texture).is_file(), "{texture} is missing");
    }
}

/// The checks detect each fault that is planted in a sound cube.
#[test]
fn faults_are_found() {
    let cube = || {
        let mut mesh = Mesh::default();
        mesh.cuboid(DVec3::ZERO, DVec3::ONE, |p, _| p.truncate());
        mesh
    };
    assert_eq!(faults(&cube(), 12), Vec::<String>::new());
    assert!((volume(&cube(), 12) - 1.0).abs() < 1e-12);
    let planted: [fn(&mut Mesh); 5] = [
        |m| m.normals[3] *= 1.1,
        |m| m.triangles[5][1] = 99,
        |m| m.triangles[5].swap(0, 1),
        |m| m.triangles[5][1] = m.triangles[5][0],
        |m| m.triangles.truncate(11),
    ];
    for (k, plant) in planted.into_iter().enumerate() {
        let mut mesh = cube();
        plant(&mut mesh);
        assert!(!faults(&mesh, 12).is_empty(), "planted fault {k} passed");
    }
}
