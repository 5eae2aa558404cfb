//! Image files.
//!
//! Theory: EXR and PFM keep every bit of a finite f32. HDR keeps 8 bits of the largest channel, so
//! a value is within 1/256 of the pixel's largest (Ward 1991). PNG keeps 8-bit display values. A
//! file is written completely or not at all.

use std::fs;
use std::path::Path;

use crate::support::{bits, folder, names};
use caustica::low_level::film::{
    Development, FileError, Picture, Provenance, check_outputs, exr_file, file, pfm, read, write,
};
use caustica::low_level::scene::settings::RenderSettings;

/// A test image: not square, without mirror symmetry, over many magnitudes, with denormal, negative
/// zero and large values.
fn sample() -> Picture {
    let mut picture = Picture::from_fn(19, 7, |x, y| {
        let base = (1.7f32).powi(x as i32 - 9);
        [base, base * (1.0 + y as f32), 0.1 + 0.01 * (x * 7 + y) as f32]
    });
    picture.rgb[0] = [1e-40, -0.0, 3e38];
    picture
}

fn provenance() -> Provenance {
    Provenance {
        scene: "two balls".into(),
        scene_text: "version = 1 # é\n".into(),
        settings: RenderSettings { seed: u64::MAX, photons: 12_345, ..RenderSettings::default() },
        device: "a device".into(),
        first_pass: 0,
        passes_done: 17,
        ..Provenance::default()
    }
}

fn write_sample(file: &Path, picture: &Picture) {
    write(file, picture, &[], &Development::default(), &provenance()).unwrap();
}

#[test]
fn float_formats_keep_every_bit() {
    let folder = folder("bits");
    for name in ["a.exr", "a.pfm", "A.EXR"] {
        let file = folder.join(name);
        write_sample(&file, &sample());
        let back = read(&file).unwrap();
        assert_eq!((back.width, back.height), (19, 7), "{name}");
        assert_eq!(bits(&back), bits(&sample()), "{name}");
        // The comparison must detect a single changed bit.
        let mut changed = sample();
        changed.rgb[40][1] = f32::from_bits(changed.rgb[40][1].to_bits() ^ 1);
        write_sample(&file, &changed);
        assert_ne!(bits(&read(&file).unwrap()), bits(&sample()), "{name}");
    }
}

#[test]
fn hdr_keeps_a_256th_of_the_largest_channel() {
    let file = folder("hdr").join("a.hdr");
    let mut picture = sample();
    picture.rgb[0] = [0.0; 3];
    write_sample(&file, &picture);
    let back = read(&file).unwrap();
    let worst = |picture: &Picture| {
        picture.rgb.iter().zip(&back.rgb).fold(0.0f32, |worst, (was, is)| {
            let largest = was.iter().fold(1e-30f32, |a, &b| a.max(b));
            (0..3).fold(worst, |worst, i| worst.max((was[i] - is[i]).abs() / largest))
        })
    };
    assert!(worst(&picture) <= 1.0 / 128.0, "{}", worst(&picture));
    picture.rgb[30][0] *= 1.05;
    assert!(worst(&picture) > 1.0 / 128.0);
}

#[test]
fn png_holds_the_developed_values() {
    let file = folder("png").join("a.png");
    write_sample(&file, &sample());
    let pixels = image::open(&file).unwrap().into_rgb8();
    let development = Development::default();
    for (index, &radiance) in sample().rgb.iter().enumerate() {
        let (x, y) = sample().position(index);
        assert_eq!(pixels.get_pixel(x, y).0, development.bytes(radiance));
    }
}

#[test]
fn exr_attributes_tell_how_the_picture_was_made() {
    let file = folder("attributes").join("a.exr");
    write_sample(&file, &sample());
    let exr = file::read_exr(&file).unwrap();
    assert_eq!(exr.attributes, provenance().attributes());
    assert_eq!(exr.attributes["caustica.seed"], u64::MAX.to_string());
    assert_eq!(exr.attributes["caustica.photons"], "12345");
    assert_eq!(exr.attributes["caustica.method"], "sppm");
    assert_eq!(exr.attributes["caustica.scene"], "two balls");
    assert_eq!(exr.attributes["caustica.scene_text"], "version = 1 # é\n");
    assert_eq!(exr.attributes["caustica.device"], "a device");
    assert_eq!(exr.attributes["caustica.passes_done"], "17");
    assert_eq!(exr.attributes["caustica.version"], env!("CARGO_PKG_VERSION"));
    let settings: RenderSettings =
        serde_json::from_str(&exr.attributes["caustica.settings"]).unwrap();
    assert_eq!(settings, provenance().settings);
}

/// Equal images must give equal files, although the attributes' hash map has a new seed each time.
#[test]
fn equal_pictures_give_equal_bytes() {
    let attributes = provenance().attributes();
    let first =
        exr_file::encode(&sample(), exr_file::Frame::of(&sample()), &[], &attributes).unwrap();
    for _ in 0..20 {
        assert!(
            exr_file::encode(&sample(), exr_file::Frame::of(&sample()), &[], &attributes).unwrap()
                == first
        );
    }
    let other = Provenance { passes_done: 18, ..provenance() };
    assert!(
        exr_file::encode(&sample(), exr_file::Frame::of(&sample()), &[], &other.attributes())
            .unwrap()
            != first
    );
}

/// Invalid outputs are refused before the render, each with its name.
#[test]
fn outputs_are_checked_up_front() {
    let folder = folder("check");
    let check = |names: &[&str]| {
        check_outputs(&names.iter().map(|name| folder.join(name)).collect::<Vec<_>>())
    };
    check(&["a.png", "b.exr", "c.pfm", "d.hdr", "e.PNG"]).unwrap();
    check_outputs(&["in-the-current-folder.png".into()]).unwrap();
    let unknown = check(&["a.png", "b.jpg"]).unwrap_err();
    assert!(matches!(unknown, FileError::UnknownFormat { .. }), "{unknown:?}");
    for name in [".png", ".exr", ".pfm", ".hdr"] {
        assert!(
            format!("{:?}", miette::Report::new(check(&["b.jpg"]).unwrap_err())).contains(name),
            "{name}"
        );
    }
    assert!(matches!(check(&["noextension"]), Err(FileError::UnknownFormat { .. })));
    assert!(matches!(check(&["no/such/a.png"]), Err(FileError::NoFolder { .. })));
    assert!(matches!(check(&["a.png", "a.png"]), Err(FileError::Repeated { .. })));
    fs::create_dir(folder.join("sub.png")).unwrap();
    assert!(matches!(check(&["sub.png"]), Err(FileError::IsFolder { .. })));
    assert_eq!(names(&folder), ["sub.png"], "checking leaves nothing");
}

/// A failed write leaves neither the file nor a part of it; a successful one replaces the old file.
#[test]
fn nothing_half_written_is_left() {
    let folder = folder("whole");
    let file = folder.join("a.pfm");
    fs::write(&file, "old").unwrap();
    write_sample(&file, &sample());
    assert_eq!(bits(&read(&file).unwrap()), bits(&sample()));
    fs::create_dir(folder.join("b.pfm")).unwrap();
    let refused =
        write(&folder.join("b.pfm"), &sample(), &[], &Development::default(), &provenance());
    assert!(matches!(refused, Err(FileError::Io { verb: "written", .. })), "{refused:?}");
    assert_eq!(names(&folder), ["a.pfm", "b.pfm"]);
}

#[test]
fn pfm_reads_grey_big_endian_and_scaled_files() {
    let mut bytes = b"Pf\n2 2\n3.0\n".to_vec();
    for value in [1.0f32, 2.0, 3.0, 4.0] {
        bytes.extend(value.to_be_bytes());
    }
    let picture = pfm::decode(&bytes).unwrap();
    // The bottom row comes first.
    assert_eq!(picture.rgb, [[9.0; 3], [12.0; 3], [3.0; 3], [6.0; 3]]);
}

#[test]
fn damaged_files_are_errors() {
    let folder = folder("damaged");
    for name in ["a.exr", "a.pfm", "a.hdr"] {
        let file = folder.join(name);
        write_sample(&file, &sample());
        let whole = fs::read(&file).unwrap();
        read(&file).unwrap();
        for length in [0, 3, 9, whole.len() / 2, whole.len() - 5] {
            fs::write(&file, &whole[..length]).unwrap();
            let error = read(&file).expect_err(name);
            assert!(
                matches!(error, FileError::Malformed { .. }),
                "{name} cut to {length}: {error:?}"
            );
        }
    }
    for header in
        ["P6\n1 1\n-1.0\n", "PF\n0 1\n-1.0\n", "PF\n1 -1\n-1.0\n", "PF\n1 1\n0\n", "PF\n1 1\nnan\n"]
    {
        let bytes = [header.as_bytes(), &[0; 12]].concat();
        assert!(pfm::decode(&bytes).is_err(), "{header:?}");
    }
    pfm::decode(&[b"PF\n1 1\n-1.0\n".as_slice(), &[0; 12]].concat()).unwrap();
    assert!(matches!(read(&folder.join("none.exr")), Err(FileError::Io { verb: "read", .. })));
    assert!(matches!(read(&folder.join("a.png")), Err(FileError::UnknownFormat { .. })));
}
