//! Output images on the CPU engine: layers, crops, 16 bits, reproduction from an image, and display
//! in tev.
//!
//! Theory: a crop and a reproduced image have the bits of the original. The image that tev's
//! protocol transmits equals the file.

use std::fs;
use std::io::Read;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::support::{FLOOR, LAMP, MESH, ball, ends, error, folder_with, write_exr};
use caustica::low_level::film::exr_file::{ExrFile, Frame};
use caustica::low_level::film::tev::Tev;
use caustica::low_level::film::{Development, Picture, file, read};

static SCENE: LazyLock<String> =
    LazyLock::new(|| ball((32, 24), "passes = 4\nphotons = 2000", &[MESH, LAMP]));

fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE), ("floor.obj", FLOOR)])
}

fn rendered(folder: &Path, arguments: &[&str]) -> String {
    error(&ends(folder, &[&["render"], arguments].concat(), 0, &[]))
}

fn refused(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    ends(folder, &[&["render"], arguments].concat(), code, words);
}

fn exr(folder: &Path, name: &str) -> ExrFile {
    file::read_exr(&folder.join(name)).unwrap()
}

#[test]
fn layers_stand_beside_radiance() {
    let folder = folder("layers");
    rendered(&folder, &["ball.toml", "--device", "cpu", "-o", "plain.exr"]);
    rendered(
        &folder,
        &["ball.toml", "--device", "cpu", "--aov", "all", "-o", "all.exr", "-o", "all.png"],
    );
    let (plain, all) = (exr(&folder, "plain.exr"), exr(&folder, "all.exr"));
    assert_eq!(plain.picture(""), all.picture(""));
    let names: Vec<&str> = all.channels.keys().map(String::as_str).collect();
    let expected = "B Bias.Y G R Variance.Y albedo.B albedo.G albedo.R caustic.B caustic.G caustic.R depth.Z direct.B direct.G \
                    direct.R emission.B emission.G emission.R indirect.B indirect.G indirect.R \
                    material.ID normal.X normal.Y normal.Z object.ID photons.Y position.X position.Y position.Z radius.Y";
    assert_eq!(names, expected.split_whitespace().collect::<Vec<_>>());
    assert_eq!(plain.channels.len(), 5);
    let of = |file: &ExrFile, name: &str| file.channels[name].clone();
    // indices: the floor, the ball with the floor's mesh behind it, and the background
    let mut ids = of(&all, "object.ID");
    ids.sort_by(f32::total_cmp);
    ids.dedup();
    assert_eq!(ids, [0.0, 1.0, 2.0]);
    assert_eq!(all.attributes["caustica.materials"], "[\"glass\",\"white\"]");
    assert_eq!(
        all.attributes["caustica.aov"],
        "albedo,normal,depth,position,object,material,emission,direct,caustic,indirect,radius,photons,variance"
    );
    // the scene file selects layers, the command line overrides it, and a PNG holds none
    fs::write(
        folder.join("ball.toml"),
        SCENE.replace("height = 24", "height = 24\naov = [\"depth\", \"albedo\"]"),
    )
    .unwrap();
    rendered(&folder, &["ball.toml", "--device", "cpu", "-o", "file.exr"]);
    let by_file = exr(&folder, "file.exr");
    assert_eq!(by_file.channels.len(), 5 + 4);
    assert_eq!(of(&by_file, "albedo.G"), of(&all, "albedo.G"));
    rendered(&folder, &["ball.toml", "--device", "cpu", "--aov", "normal", "-o", "line.exr"]);
    assert_eq!(exr(&folder, "line.exr").channels.len(), 5 + 3);
    rendered(&folder, &["ball.toml", "--device", "cpu", "-o", "a.png"]);
    refused(
        &folder,
        &["ball.toml", "--aov", "depth", "-o", "a.png"],
        2,
        &["no output can store", "-o picture.exr"],
    );
    refused(&folder, &["ball.toml", "--aov", "depht"], 2, &["did you mean `depth`?"]);
    fs::write(
        folder.join("ball.toml"),
        SCENE.replace("height = 24", "height = 24\naov = [\"albedoo\"]"),
    )
    .unwrap();
    refused(&folder, &["ball.toml"], 1, &["did you mean `albedo`?"]);
}

#[test]
fn a_window_is_a_part_of_the_picture() {
    let folder = folder("window");
    let run = ["ball.toml", "--device", "cpu", "--aov", "depth"];
    rendered(&folder, &[&run[..], &["-o", "whole.exr", "-o", "whole.pfm"]].concat());
    let crop = ["--crop", "10,4,25,19", "-o", "part.exr", "-o", "part.png", "-o", "part.pfm"];
    rendered(&folder, &[&run[..], &crop].concat());
    let (whole, part) = (exr(&folder, "whole.exr"), exr(&folder, "part.exr"));
    assert_eq!(part.frame, Frame { x: 10, y: 4, width: 32, height: 24 });
    assert_eq!(whole.frame, Frame { x: 0, y: 0, width: 32, height: 24 });
    assert_eq!((part.width, part.height), (15, 15));
    for name in ["R", "G", "B", "depth.Z", "Variance.Y"] {
        for (i, value) in part.channels[name].iter().enumerate() {
            let (x, y) = (10 + i % 15, 4 + i / 15);
            assert_eq!(
                value.to_bits(),
                whole.channels[name][y * 32 + x].to_bits(),
                "{name} at {x}, {y}"
            );
        }
    }
    let shifted = |i: usize| whole.channels["R"][(4 + i / 15) * 32 + 11 + i % 15];
    assert!(
        part.channels["R"].iter().enumerate().any(|(i, r)| *r != shifted(i)),
        "the next column differs"
    );
    assert_eq!(image::open(folder.join("part.png")).unwrap().width(), 15);
    assert_eq!(read(&folder.join("part.pfm")).unwrap(), part.picture("").unwrap());
    for wrong in ["10,4,33,19", "0,0,32,25"] {
        refused(
            &folder,
            &["ball.toml", "--crop", wrong],
            2,
            &["beyond the image", "32 columns and 24 rows"],
        );
    }
    for wrong in ["10,4,10,19", "1,2,3", "-1,0,4,4", "a"] {
        refused(&folder, &["ball.toml", "--crop", wrong], 2, &["four whole numbers with x0 < x1"]);
    }
    // the crop refers to the image size on the command line
    rendered(
        &folder,
        &["ball.toml", "--device", "cpu", "--size", "64x48", "--crop", "40,30,64,48"],
    );
}

#[test]
fn sixteen_bits_hold_what_eight_round() {
    let folder = folder("bits");
    let outputs = ["-o", "a.png", "-o", "a.exr"];
    rendered(&folder, &[&["ball.toml", "--device", "cpu", "--bits", "16"][..], &outputs].concat());
    let image = image::open(folder.join("a.png")).unwrap();
    assert_eq!(image.color(), image::ColorType::Rgb16);
    let (image, picture) = (image.into_rgb16(), read(&folder.join("a.exr")).unwrap());
    let development = Development::default();
    let mut finer = 0;
    for (i, &radiance) in picture.rgb.iter().enumerate() {
        let (x, y) = picture.position(i);
        let found = image.get_pixel(x, y).0;
        assert_eq!(found, development.words(radiance));
        for (word, value) in found.into_iter().zip(development.display(radiance)) {
            assert!((f64::from(word) / 65535.0 - value).abs() <= 0.5 / 65535.0 + 1e-12);
        }
        finer += found.iter().filter(|word| **word % 257 != 0).count();
    }
    assert!(finer > 1000, "{finer} values lie between those of 8 bits");
    rendered(&folder, &["ball.toml", "--device", "cpu", "-o", "b.png"]);
    assert_eq!(image::open(folder.join("b.png")).unwrap().color(), image::ColorType::Rgb8);
    refused(&folder, &["ball.toml", "--bits", "12"], 2, &["expected 8 or 16"]);
}

/// `tests/film/denoise.rs` tests a build with the denoiser.
#[cfg(not(feature = "denoise"))]
#[test]
fn a_denoiser_that_is_not_built_in_is_told() {
    let folder = folder("denoise");
    let words =
        ["--denoise: this build of caustica has no denoiser", "OIDN_DIR", "--features denoise"];
    refused(&folder, &["ball.toml", "--device", "cpu", "--denoise"], 2, &words);
    assert!(!folder.join("ball.png").exists());
}

/// The channels of an image, without the attributes that differ between runs.
fn bits(file: &ExrFile) -> Vec<(String, Vec<u32>)> {
    let bits = |values: &Vec<f32>| values.iter().map(|value| value.to_bits()).collect();
    file.channels.iter().map(|(name, values)| (name.clone(), bits(values))).collect()
}

#[test]
fn a_picture_is_made_again() {
    let folder = folder("like");
    for (name, options) in [
        ("plain", &["--device", "cpu"][..]),
        (
            "window",
            &[
                "--device",
                "cpu",
                "--crop",
                "3,4,20,20",
                "--size",
                "40x30",
                "--aov",
                "albedo,object",
            ],
        ),
        (
            "ppm",
            &[
                "--device",
                "cpu",
                "--method",
                "ppm",
                "--eye-samples",
                "3",
                "--seed",
                "77",
                "--radius-rule",
                "local",
            ],
        ),
        ("double", &["--device", "cpu-f64", "--quality", "draft", "--passes", "5"]),
        ("stopped", &["--device", "cpu", "--target-error", "20%"]),
    ] {
        let (first, again) = (format!("{name}.exr"), format!("{name}-again.exr"));
        rendered(&folder, &[&["ball.toml", "-o", &first][..], options].concat());
        let reported = rendered(&folder, &["--like", &first]);
        assert!(!reported.contains("warning"), "{reported}");
        assert!(
            fs::read(folder.join(&first)).unwrap() == fs::read(folder.join(&again)).unwrap()
                || bits(&exr(&folder, &first)) == bits(&exr(&folder, &again)),
            "{name}"
        );
        assert_eq!(exr(&folder, &first).frame, exr(&folder, &again).frame);
    }
    // another seed gives another image, so the comparison can fail and options take effect
    rendered(&folder, &["--like", "plain.exr", "--seed", "5", "-o", "other.exr"]);
    assert_ne!(bits(&exr(&folder, "plain.exr")), bits(&exr(&folder, "other.exr")));
    // a changed mesh gives a warning; a missing scene file is replaced by the text in the image
    fs::write(folder.join("floor.obj"), FLOOR.replace("v 3 0 -3", "v 3 0 -3.01")).unwrap();
    let reported = rendered(&folder, &["--like", "plain.exr", "-o", "changed.exr"]);
    assert!(reported.contains("a file that it uses has changed"), "{reported}");
    fs::write(folder.join("floor.obj"), FLOOR).unwrap();
    fs::rename(folder.join("ball.toml"), folder.join("moved.toml")).unwrap();
    let reported = rendered(&folder, &["--like", "plain.exr", "-o", "text.exr"]);
    assert!(
        reported.contains("read from the text in plain.exr") && !reported.contains("warning"),
        "{reported}"
    );
    assert_eq!(bits(&exr(&folder, "plain.exr")), bits(&exr(&folder, "text.exr")));
    // a scene named on the command line is used wherever it is
    let reported = rendered(&folder, &["moved.toml", "--like", "plain.exr", "-o", "moved.exr"]);
    assert!(!reported.contains("warning") && !reported.contains("from the text"), "{reported}");
    assert_eq!(bits(&exr(&folder, "plain.exr")), bits(&exr(&folder, "moved.exr")));
    // an image of another version
    let mut bytes = fs::read(folder.join("plain.exr")).unwrap();
    let here = [
        b"caustica.version\0string\0".as_slice(),
        &(env!("CARGO_PKG_VERSION").len() as u32).to_le_bytes(),
    ]
    .concat();
    let at = bytes.windows(here.len()).position(|w| w == here).unwrap() + here.len();
    bytes[at] = b'9';
    fs::write(folder.join("future.exr"), bytes).unwrap();
    let reported = rendered(&folder, &["moved.toml", "--like", "future.exr", "-o", "b.exr"]);
    assert!(reported.contains("rendered by version 9"), "{reported}");
    // images of other programs
    let picture = Picture::from_fn(2, 2, |_, _| [1.0; 3]);
    write_exr(&folder.join("foreign.exr"), &picture);
    refused(&folder, &["--like", "foreign.exr"], 1, &["the attribute caustica."]);
    refused(&folder, &["--like", "none.exr"], 1, &["none.exr"]);
    refused(&folder, &[], 2, &["SCENE"]);
}

/// The image that a viewer assembles from the packets.
#[derive(Default)]
struct Shown {
    name: String,
    width: usize,
    height: usize,
    channels: Vec<String>,
    /// By channel, row by row; update packets fill it in.
    values: Vec<Vec<f32>>,
    updates: usize,
}

struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N);
        self.0 = rest;
        head.try_into().unwrap()
    }

    fn int(&mut self) -> usize {
        usize::try_from(i32::from_le_bytes(self.take())).unwrap()
    }

    fn long(&mut self) -> usize {
        usize::try_from(i64::from_le_bytes(self.take())).unwrap()
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap();
        let text = String::from_utf8(self.0[..end].to_vec()).unwrap();
        self.0 = &self.0[end + 1..];
        text
    }
}

impl Shown {
    fn of(bytes: &[u8]) -> Self {
        let (mut shown, mut rest) = (Self::default(), bytes);
        while !rest.is_empty() {
            let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
            shown.packet(Fields(&rest[4..length]));
            rest = &rest[length..];
        }
        shown
    }

    fn packet(&mut self, mut fields: Fields) {
        let [kind, _focus] = fields.take::<2>();
        let name = fields.text();
        match kind {
            4 => {
                (self.width, self.height, self.name) = (fields.int(), fields.int(), name);
                let count = fields.int();
                self.channels = (0..count).map(|_| fields.text()).collect();
                self.values = vec![vec![0.0; self.width * self.height]; count];
            }
            6 => {
                assert_eq!(name, self.name);
                let count = fields.int();
                let names: Vec<String> = (0..count).map(|_| fields.text()).collect();
                let [x, y, width, height] = [(); 4].map(|()| fields.int());
                let offsets: Vec<usize> = (0..count).map(|_| fields.long()).collect();
                let strides: Vec<usize> = (0..count).map(|_| fields.long()).collect();
                let data: Vec<f32> = fields
                    .0
                    .chunks_exact(4)
                    .map(|word| f32::from_le_bytes(word.try_into().unwrap()))
                    .collect();
                assert_eq!(data.len(), width * height * count);
                for (c, name) in names.iter().enumerate() {
                    let channel = self.channels.iter().position(|own| own == name).unwrap();
                    for i in 0..width * height {
                        let place = (y + i / width) * self.width + x + i % width;
                        self.values[channel][place] = data[offsets[c] + i * strides[c]];
                    }
                }
                self.updates += 1;
            }
            other => panic!("a packet of kind {other}"),
        }
    }
}

/// Starts a viewer that receives all packets; returns its thread and address.
fn viewer() -> (std::thread::JoinHandle<Vec<u8>>, String) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let taken = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        listener.accept().unwrap().0.read_to_end(&mut bytes).unwrap();
        bytes
    });
    (taken, address)
}

#[test]
fn tev_is_sent_the_picture() {
    let folder = folder("tev");
    for crop in [None, Some([5, 6, 30, 20])] {
        let (taken, address) = viewer();
        let tev = format!("--tev={address}");
        let mut options = vec!["ball.toml", "--device", "cpu", "-o", "a.exr", &tev];
        let window = crop.map(|crop: [u32; 4]| crop.map(|x| x.to_string()).join(","));
        if let Some(window) = &window {
            options.extend(["--crop", window]);
        }
        rendered(&folder, &options);
        let shown = Shown::of(&taken.join().unwrap());
        let channels: Vec<&str> = shown.channels.iter().map(String::as_str).collect();
        assert_eq!((shown.name.as_str(), shown.width, shown.height), ("ball", 32, 24));
        assert_eq!(channels, ["R", "G", "B"]);
        assert!(shown.updates >= 2, "after the first pass and at the end: {}", shown.updates);
        let exr = exr(&folder, "a.exr");
        let mut expected = vec![vec![0.0; 32 * 24]; 3];
        for (i, rgb) in exr.picture("").unwrap().rgb.iter().enumerate() {
            let (x, y) = (i % exr.width as usize, i / exr.width as usize);
            let place = (exr.frame.y as usize + y) * 32 + exr.frame.x as usize + x;
            (0..3).for_each(|c| expected[c][place] = rgb[c]);
        }
        assert!(shown.values == expected, "{crop:?}");
    }
    // without a viewer the command fails before it renders
    let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    refused(
        &folder,
        &["ball.toml", "--device", "cpu", &format!("--tev={closed}")],
        1,
        &["no viewer", "start tev"],
    );
    refused(
        &folder,
        &["ball.toml", "--device", "cpu", "--tev=nowhere"],
        1,
        &["no viewer at nowhere"],
    );
}

/// A viewer that disconnects does not end the render.
#[test]
fn a_viewer_may_go_away() {
    let folder = folder("gone");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let tev = format!("--tev={}", listener.local_addr().unwrap());
    let gone = std::thread::spawn(move || drop(listener.accept().unwrap()));
    let options =
        ["ball.toml", "--device", "cpu", "--size", "400x300", "--passes", "6", "-o", "a.exr", &tev];
    let reported = rendered(&folder, &options);
    gone.join().unwrap();
    assert!(reported.contains("connection to tev lost"), "{reported}");
    assert_eq!(exr(&folder, "a.exr").attributes["caustica.passes_done"], "6");
}

/// An image too large for one packet is sent in several and arrives complete.
#[test]
fn large_pictures_come_in_parts() {
    let picture = Picture::from_fn(1500, 700, |x, y| [x as f32, y as f32, (x * y) as f32]);
    let mut bytes = Vec::new();
    let mut tev = Tev::open(&mut bytes, "large\0picture", Frame::of(&picture)).unwrap();
    tev.show(&picture).unwrap();
    let shown = Shown::of(&bytes);
    assert!(shown.updates > 1 && shown.name == "largepicture");
    for (i, rgb) in picture.rgb.iter().enumerate() {
        assert!((0..3).all(|c| shown.values[c][i] == rgb[c]), "pixel {i}");
    }
}
