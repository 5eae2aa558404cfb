//! `render --denoise` with Open Image Denoise: `cargo test --release --features denoise --test denoise`.
//!
//! Theory: the mean square of independent noise falls where like pixels are averaged, and a path-traced picture is full of it, so that a
//! denoised one is many times nearer to what photons make of the scene in a long render. It is so only if the layers lie over the picture as they should. Radiance has
//! no upper bound, so a picture in another unit is the same picture in that unit. Nothing else knows of it: all that is measured has
//! the same bits.

#![cfg(feature = "denoise")]

mod support;

use std::path::Path;

use caustica::film::denoise::Denoiser;
use caustica::film::exr_file::{Channel, ExrFile, Frame};
use caustica::film::metrics::compare;
use caustica::film::{Development, Picture, Plane, file, read};
use support::{ends, folder, json_lines};

const NAMES: [&str; 6] = ["albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"];

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.toml");
const ON: [&str; 6] = ["render", SCENE, "--device", "cpu", "--size", "96x72"];

/// By path tracing with few paths.
fn rendered(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    ends(folder, &[&ON[..], &["--method", "path", "--passes", "8"], arguments].concat(), 0, &[]).stdout
}

fn exr(folder: &Path, name: &str) -> ExrFile {
    file::read_exr(&folder.join(name)).unwrap()
}

/// The layers that guide, each value from the row that `row` names.
fn guides(file: &ExrFile, row: impl Fn(usize) -> usize) -> Vec<Channel> {
    let width = file.width as usize;
    let plane = |name| {
        let rows = (0..file.height as usize).flat_map(|y| &file.channels[name][row(y) * width..][..width]);
        Plane { width, values: rows.map(|&value| f64::from(value)).collect() }
    };
    NAMES.map(|name| Channel::float(name, plane(name))).into()
}

fn error(picture: &Picture, truth: &Picture) -> f64 {
    compare(picture, truth).unwrap().rel_mse
}

#[test]
fn a_denoised_picture_is_nearer_to_the_truth() {
    let folder = folder("nearer");
    ends(&folder, &[&ON[..], &["--passes", "32", "-o", "truth.pfm"]].concat(), 0, &[]); // by photons
    rendered(&folder, &["--denoise", "--aov", "albedo,normal", "-o", "a.exr"]);
    let (truth, a) = (read(&folder.join("truth.pfm")).unwrap(), exr(&folder, "a.exr"));
    let (noisy, denoised) = (a.picture("").unwrap(), a.picture("denoised.").unwrap());
    let [before, after] = [&noisy, &denoised].map(|picture| error(picture, &truth));
    assert!(after < before / 5.0, "relMSE {before} before, {after} after");
    // the library alone makes the same, and a worse one where the layers are upside down
    let denoiser = Denoiser::open().unwrap();
    assert_eq!(denoiser.denoise(&noisy, &guides(&a, |y| y)).unwrap(), denoised);
    let over = denoiser.denoise(&noisy, &guides(&a, |y| 71 - y)).unwrap();
    let planted = error(&over, &truth);
    assert!(planted > 1.2 * after, "relMSE {planted} with layers upside down, {after} as they are");
    // a picture of another size than its layers, and one without
    let part = Picture { height: 71, rgb: noisy.rgb[96..].to_vec(), ..noisy };
    let what = denoiser.denoise(&part, &guides(&a, |y| y)).unwrap_err().to_string();
    assert!(what.contains("Open Image Denoise 2: ") && what.contains("size"), "{what}");
    let what = denoiser.denoise(&noisy, &guides(&a, |y| y)[..5]).unwrap_err().to_string();
    assert!(what.contains("normal.Z is missing"), "{what}");
}

#[test]
fn radiance_may_be_in_any_unit() {
    let folder = folder("unit");
    rendered(&folder, &["--denoise", "--aov", "albedo,normal", "-o", "a.exr"]);
    let a = exr(&folder, "a.exr");
    let (noisy, denoised) = (a.picture("").unwrap(), a.picture("denoised.").unwrap());
    let scaled =
        |p: &Picture, k: f32| Picture { rgb: p.rgb.iter().map(|rgb| rgb.map(|x| k * x)).collect(), ..*p };
    let bright = Denoiser::open().unwrap().denoise(&scaled(&noisy, 1024.0), &guides(&a, |y| y)).unwrap();
    let differs = error(&scaled(&bright, 1.0 / 1024.0), &denoised);
    assert!(differs < 1e-4, "relMSE {differs}");
    // planted: values cut at 1, as display values are
    let cut = Picture { rgb: denoised.rgb.iter().map(|rgb| rgb.map(|x| x.min(1.0))).collect(), ..denoised };
    let differs = error(&cut, &denoised);
    assert!(differs > 1e-4, "relMSE {differs} where the lamp is cut");
}

#[test]
fn nothing_measured_sees_it() {
    let folder = folder("unseen");
    let done = |arguments: &[&str]| json_lines(&rendered(&folder, arguments)).pop().unwrap();
    let plain = done(&["--json", "-o", "plain.exr"]);
    let outputs = ["-o", "a.exr", "-o", "a.png", "-o", "a.pfm", "-o", "a.hdr"];
    let denoised = done(&[&["--json", "--denoise"][..], &outputs].concat());
    for key in ["error", "error_noise", "error_bias", "photons", "rays"] {
        assert_eq!(plain[key], denoised[key], "{key}");
    }
    let [plain, a] = ["plain.exr", "a.exr"].map(|name| exr(&folder, name));
    let mut names: Vec<_> = plain.channels.keys().map(String::as_str).collect();
    for name in &names {
        let bits = |file: &ExrFile| file.channels[*name].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&plain), bits(&a), "{name}");
    }
    names.extend(["denoised.B", "denoised.G", "denoised.R"]);
    names.sort();
    assert_eq!(a.channels.keys().map(String::as_str).collect::<Vec<_>>(), names);
    assert_eq!(read(&folder.join("a.pfm")).unwrap(), plain.picture("").unwrap());
    // what says how it was made tells of it, and does not ask for the layers that were only lent
    assert_eq!(a.attributes["caustica.denoised"], "Open Image Denoise 2");
    assert!(!plain.attributes.contains_key("caustica.denoised"));
    assert!(!a.attributes.contains_key("caustica.aov"));
    // a PNG file shows the denoised picture, which is another one
    let image = image::open(folder.join("a.png")).unwrap().into_rgb8();
    let shows = |picture: &Picture| {
        let of = |i: usize| image.get_pixel(picture.position(i).0, picture.position(i).1).0;
        picture.rgb.iter().enumerate().all(|(i, &rgb)| of(i) == Development::default().bytes(rgb))
    };
    assert!(shows(&a.picture("denoised.").unwrap()));
    assert!(!shows(&a.picture("").unwrap()));
}

#[test]
fn windows_are_denoised_as_well() {
    let folder = folder("window");
    for crop in ["10,4,41,19", "50,30,51,31"] {
        rendered(&folder, &["--denoise", "--crop", crop, "--aov", "normal", "-o", "part.exr"]);
        let part = exr(&folder, "part.exr");
        let denoised = part.picture("denoised.").unwrap();
        assert_eq!(denoised.not_finite(), 0);
        assert_eq!((part.frame.width, part.frame.height), (96, 72), "{:?}", Frame::of(&denoised));
        assert!(part.channels.contains_key("normal.X") && !part.channels.contains_key("albedo.R"));
    }
}

#[test]
fn a_file_that_holds_the_render_alone_is_not_enough() {
    let folder = folder("alone");
    for output in ["a.pfm", "a.hdr"] {
        let words = ["hold the render alone", "extension .png, or .exr"];
        ends(&folder, &["render", SCENE, "--denoise", "-o", output], 2, &words);
    }
}
