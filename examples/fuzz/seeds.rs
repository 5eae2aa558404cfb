//! Seeds: the shipped scenes, small meshes and images, and checkpoints.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use caustica::low_level::checkpoint::{self, Checkpoint, Origin, Totals};
use caustica::low_level::device::{self, Opened, Wanted};
use caustica::low_level::scene::settings::RadiusRule;
use caustica::low_level::scene::{self, Loaded};
use image::{DynamicImage, ImageFormat};

use crate::targets::Target;

const OBJ: &str = "mtllib mesh.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n\
                   vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
g one\nf 1/1/1 2/2/1 3/3/1 4/1/1\nusemtl b\ng two\nf 1 2 5\nf -1 -2 -3\nusemtl c\nf 4 3 2 1 5\n";
const MTL: &str = "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd t.png\nnewmtl b\nillum 5\nKs 0.9 0.9 0.9\n\
                   Ns 10\nnewmtl c\nNi 1.5\nd 0.1\n\
illum 7\nKe 1 1 1\n";
/// Scene that reads the files of the other targets.
pub const READER: &str = "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\n\
                          fov = 39\n\
[[lights]]\ntype = \"point\"\nposition = [0, 3, 0]\nintensity = 1.0\n";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Creates a folder with all files that the seeds refer to.
pub fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("caustica-fuzz-{name}"));
    fs::create_dir_all(&folder).expect("a folder for broken files");
    let picture = picture(ImageFormat::Png);
    let sky = picture_of(ImageFormat::Hdr, true);
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("a file");
    for name in
        ["car.png", "porcelain.png", "planks.png", "grass.png", "stone.png", "grid.png", "t.png"]
    {
        write(name, &picture);
    }
    for name in ["car.obj", "car-chrome.obj", "house.obj", "torus.obj", "mesh.obj"] {
        write(name, OBJ.as_bytes());
    }
    write("mesh.mtl", MTL.as_bytes());
    write("sky.hdr", &sky);
    folder
}

/// Seeds of a target.
pub fn of(target: Target) -> Vec<Vec<u8>> {
    match target {
        Target::Scene | Target::Plan => scenes(),
        Target::Obj => vec![
            OBJ.into(),
            read("tests/data/cube.obj"),
            read("tests/data/broken.obj"),
            read("tests/data/parts.obj"),
        ],
        Target::Mtl => vec![
            MTL.into(),
            read("tests/data/broken.mtl"),
            read("tests/data/parts.mtl"),
            read("assets/house.mtl"),
        ],
        Target::Ply => plys(),
        Target::Texture => pictures(),
        Target::Profile => vec![
            read("scenes/profiles/vase.toml"),
            b"profile = [[0.0, 0.0], [0.6, 0.0], [0.55, 0.6], [0.0, 1.05]]\n\
              transform = { translate = [0, 1, 0] }\n"
                .to_vec(),
            b"segments = [[[0, 0], [1, 0]], [[1, 0], [1, 1], [0, 1]]]\n".to_vec(),
        ],
        Target::Checkpoint => [RadiusRule::Global, RadiusRule::Local].map(checkpoint).into(),
    }
}

fn read(file: &str) -> Vec<u8> {
    fs::read(root().join(file)).expect("a file of this repository")
}

fn scenes() -> Vec<Vec<u8>> {
    let mut scenes = Vec::new();
    for folder in ["scenes", "scenes/studies", "tests/data/reference"] {
        let entries = fs::read_dir(root().join(folder)).expect("a folder of this repository");
        let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        files.sort();
        for file in files
            .iter()
            .filter(|file| file.extension().is_some_and(|extension| extension == "toml"))
        {
            let text = fs::read_to_string(file).expect("a scene");
            scenes.push(text.replace("../assets/", "").into_bytes());
        }
    }
    scenes
}

/// A PLY file in all encodings, with an element and properties that are not used.
fn plys() -> Vec<Vec<u8>> {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment seed\nelement vertex 4\nproperty float x\n\
             property double y\n\
             property short z\nproperty float nx\nproperty float ny\nproperty float nz\n\
             property float s\nproperty float t\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
             property list uchar int vertex_indices\nproperty list uchar float texcoord\n\
             element edge 1\nproperty int a\nend_header\n"
        )
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let faces: [(&[i32], usize); 2] = [(&[0, 1, 2, 3], 0), (&[2, 1, 0], 6)];
    let mut text = header("ascii");
    let [mut little, mut big] =
        ["binary_little_endian", "binary_big_endian"].map(|format| header(format).into_bytes());
    let mut put = |bytes: &[u8], word: String| {
        little.extend(bytes);
        big.extend(bytes.iter().rev());
        text += &word;
    };
    for [x, y] in corners {
        put(&(x as f32).to_le_bytes(), format!("{x}"));
        put(&f64::to_le_bytes(y), format!(" {y}"));
        put(&[0, 0], " 0".to_owned());
        for number in [0.0f32, 0.0, 1.0, x as f32, y as f32] {
            put(&number.to_le_bytes(), format!(" {number}"));
        }
        (0..3).for_each(|_| put(&[200], " 200".to_owned()));
        put(&[], "\n".to_owned());
    }
    for (corners, uvs) in faces {
        put(&[corners.len() as u8], format!("{}", corners.len()));
        corners.iter().for_each(|corner| put(&corner.to_le_bytes(), format!(" {corner}")));
        put(&[uvs as u8], format!(" {uvs}"));
        (0..uvs).for_each(|_| put(&0.5f32.to_le_bytes(), " 0.5".to_owned()));
        put(&[], "\n".to_owned());
    }
    put(&7i32.to_le_bytes(), "7\n".to_owned());
    vec![text.into_bytes(), little, big]
}

fn picture(format: ImageFormat) -> Vec<u8> {
    picture_of(format, false)
}

fn picture_of(format: ImageFormat, float: bool) -> Vec<u8> {
    let image = image::RgbImage::from_fn(6, 5, |x, y| image::Rgb([x as u8 * 40, y as u8 * 50, 7]));
    let image = DynamicImage::from(image);
    encode(&if float { image.to_rgb32f().into() } else { image }, format)
}

fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).expect("an encoded picture");
    bytes.into_inner()
}

fn pictures() -> Vec<Vec<u8>> {
    let image =
        image::RgbaImage::from_fn(6, 5, |x, y| image::Rgba([x as u8 * 40, y as u8 * 50, 7, 250]));
    let image = DynamicImage::from(image);
    let mut pictures = vec![
        picture(ImageFormat::Png),
        picture(ImageFormat::Jpeg),
        picture_of(ImageFormat::Hdr, true),
        encode(&image, ImageFormat::Png),
        encode(&image.to_rgba16().into(), ImageFormat::Png),
        encode(&image.to_luma_alpha8().into(), ImageFormat::Png),
        encode(&image.to_luma16().into(), ImageFormat::Png),
        encode(&image.to_luma8().into(), ImageFormat::Jpeg),
    ];
    let file = std::env::temp_dir().join(format!("caustica-fuzz-{}.exr", std::process::id()));
    exr::prelude::write_rgb_file(&file, 6, 5, |x, y| (x as f32, y as f32, 0.5f32))
        .expect("an EXR file");
    pictures.push(fs::read(&file).expect("an EXR file"));
    let _ = fs::remove_file(file);
    pictures
}

/// Scene and engine of the checkpoints.
pub fn opened(rule: RadiusRule) -> (Loaded, Opened) {
    let text = format!(
        "{READER}[film]\nwidth = 3\nheight = 2\n[render]\nphotons = 10\n[materials.m]\n\
         type = \"diffuse\"\nreflectance = 0.5\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\nmaterial = \"m\"\n"
    );
    let mut loaded = scene::parse("seed.toml".as_ref(), text.as_bytes()).expect("a scene");
    loaded.scene.film.aovs = scene::Aovs::parse("all").expect("layers");
    loaded.scene.film.window = Some([1, 0, 3, 2]);
    loaded.settings.radius_rule = rule;
    let opened =
        device::open(&Wanted::Cpu, &loaded.scene, &loaded.settings).expect("the CPU engine");
    (loaded, opened)
}

fn checkpoint(rule: RadiusRule) -> Vec<u8> {
    let (loaded, mut opened) = opened(rule);
    opened.engine.pass().expect("a pass");
    let checkpoint = Checkpoint {
        origin: Origin::of(&opened, &loaded.scene, ""),
        totals: Totals::default(),
        state: opened.engine.save().expect("an engine state"),
        cuts: Vec::new(),
    };
    let file =
        std::env::temp_dir().join(format!("caustica-fuzz-{}.checkpoint", std::process::id()));
    checkpoint::write(&file, &checkpoint).expect("a checkpoint");
    let bytes = fs::read(&file).expect("a checkpoint");
    let _ = fs::remove_file(file);
    bytes
}
