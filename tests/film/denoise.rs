//! `render --denoise` with Open Image Denoise: `cargo test --release --features denoise --test film
//! -- denoise`.
//!
//! Theory: averaging similar pixels reduces the mean square of independent noise. A path-traced
//! image is full of such noise, so its denoised version is many times closer to a long
//! photon-mapped render. Layers guide the filter only if they are aligned with the image. Radiance
//! has no upper bound, so the filter commutes with a change of unit. Denoising affects nothing
//! else: every measurement has the same bits.

use std::path::Path;

use crate::support::{ends, folder, json_lines};
use caustica::low_level::film::denoise::Denoiser;
use caustica::low_level::film::exr_file::{Channel, ExrFile, Frame};
use caustica::low_level::film::metrics::compare;
use caustica::low_level::film::{Development, Picture, Plane, file, read};

const NAMES: [&str; 6] = ["albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"];

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.toml");
const ON: [&str; 6] = ["render", SCENE, "--device", "cpu", "--size", "96x72"];

/// Renders by path tracing with few paths.
fn rendered(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    ends(folder, &[&ON[..], &["--method", "path", "--passes", "8"], arguments].concat(), 0, &[])
        .stdout
}

fn exr(folder: &Path, name: &str) -> ExrFile {
    file::read_exr(&folder.join(name)).unwrap()
}

/// Reads the guiding layers of a file.
fn guides(file: &ExrFile) -> Vec<Channel> {
    let [albedo, normal] = [&NAMES[..3], &NAMES[3..]].map(|names| {
        let at = |i: usize| [0, 1, 2].map(|c: usize| file.channels[names[c]][i]);
        Picture::from_fn(file.width, file.height, |x, y| at((y * file.width + x) as usize))
    });
    layers(&albedo, &normal)
}

fn layers(albedo: &Picture, normal: &Picture) -> Vec<Channel> {
    let of = [albedo, normal].into_iter().flat_map(|layer| (0..3).map(move |c| (layer, c)));
    let plane = |(layer, c): (&Picture, usize)| Plane::of(layer, |rgb| f64::from(rgb[c]));
    NAMES.into_iter().zip(of).map(|(name, of)| Channel::float(name, plane(of))).collect()
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
    // calling the library directly gives the same
    let denoiser = Denoiser::open().unwrap();
    assert_eq!(denoiser.denoise(&noisy, &guides(&a)).unwrap(), denoised);
    // refuses an image of another size than its layers, and one without layers
    let part = Picture { height: 71, rgb: noisy.rgb[96..].to_vec(), ..noisy };
    let what = denoiser.denoise(&part, &guides(&a)).unwrap_err().to_string();
    assert!(what.contains("Open Image Denoise 2: ") && what.contains("size"), "{what}");
    let what = denoiser.denoise(&noisy, &guides(&a)[..5]).unwrap_err().to_string();
    assert!(what.contains("normal.Z, which is missing"), "{what}");
}

/// Theory: stripes hidden in noise can only be recovered with layers that show their place and
/// colour.
#[test]
fn layers_lead_the_filter() {
    let colors = [[0.8, 0.1, 0.2], [0.1, 0.3, 0.8], [0.6, 0.7, 0.1]];
    let striped = |order: [usize; 3], width: u32, first: u32| {
        Picture::from_fn(96, 96, |x, y| {
            order.map(|c| colors[((x + y + first) / width % 3) as usize][c])
        })
    };
    let truth = striped([0, 1, 2], 5, 0);
    let facing = Picture::from_fn(96, 96, |_, _| [0.0, 0.0, 1.0]);
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        -(((state >> 40) as f32 + 0.5) / (1 << 24) as f32).ln()
    };
    let rgb = truth.rgb.iter().map(|rgb| rgb.map(|x| x * noise())).collect();
    let noisy = Picture { rgb, ..truth };
    let denoiser = Denoiser::open().unwrap();
    let led_by = |albedo: &Picture| {
        error(&denoiser.denoise(&noisy, &layers(albedo, &facing)).unwrap(), &truth)
    };
    let right = led_by(&truth);
    // planted errors: channels in another order, stripes elsewhere, no layers
    let wrong = [striped([2, 0, 1], 5, 0), striped([0, 1, 2], 5, 7), striped([0, 1, 2], 1000, 0)];
    for wrong in wrong.map(|albedo| led_by(&albedo)) {
        assert!(
            wrong > 2.0 * right,
            "relMSE {wrong} with wrong layers, {right} with the right ones"
        );
    }
}

#[test]
fn radiance_may_be_in_any_unit() {
    let folder = folder("unit");
    rendered(&folder, &["--denoise", "--aov", "albedo,normal", "-o", "a.exr"]);
    let a = exr(&folder, "a.exr");
    let (noisy, denoised) = (a.picture("").unwrap(), a.picture("denoised.").unwrap());
    let scaled = |p: &Picture, k: f32| Picture {
        rgb: p.rgb.iter().map(|rgb| rgb.map(|x| k * x)).collect(),
        ..*p
    };
    let bright = Denoiser::open().unwrap().denoise(&scaled(&noisy, 1024.0), &guides(&a)).unwrap();
    let differs = error(&scaled(&bright, 1.0 / 1024.0), &denoised);
    assert!(differs < 1e-4, "relMSE {differs}");
    // planted error: values clipped at 1, like display values
    let cut = Picture {
        rgb: denoised.rgb.iter().map(|rgb| rgb.map(|x| x.min(1.0))).collect(),
        ..denoised
    };
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
        let bits =
            |file: &ExrFile| file.channels[*name].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&plain), bits(&a), "{name}");
    }
    names.extend(["denoised.B", "denoised.G", "denoised.R"]);
    names.sort();
    assert_eq!(a.channels.keys().map(String::as_str).collect::<Vec<_>>(), names);
    assert_eq!(read(&folder.join("a.pfm")).unwrap(), plain.picture("").unwrap());
    // the attributes mention the denoiser and do not request layers that were only used as guides
    assert_eq!(a.attributes["caustica.denoised"], "Open Image Denoise 2");
    assert!(!plain.attributes.contains_key("caustica.denoised"));
    assert!(!a.attributes.contains_key("caustica.aov"));
    // a PNG file contains the denoised image, which differs
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
        let words = ["store only the render", "extension .png, or .exr"];
        ends(&folder, &["render", SCENE, "--denoise", "-o", output], 2, &words);
    }
}
