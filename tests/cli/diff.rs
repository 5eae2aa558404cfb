//! `caustica diff`.
//!
//! Theory: images of constant known values have metrics in closed form. A metric beyond its
//! threshold gives exit code 3, an unusable image 1 and unusable arguments 2, each with a message
//! that names the cause.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::support::{self, text, write_exr};
use caustica::low_level::film::{Coding, Picture, pfm, read_any};
use exr::prelude::{Image, SpecificChannels, WritableImage};
use serde_json::Value;

/// An image that is 0.25 left of column `bright` and 0.5 from there on.
fn picture(width: u32, bright: u32) -> Picture {
    Picture::from_fn(width, 24, |x, _| if x < bright { [0.25; 3] } else { [0.5; 3] })
}

/// A fresh folder with images to compare. `a.exr` and `b.exr` differ in the columns 32 to 39 of 40.
fn folder(name: &str) -> PathBuf {
    let folder = support::folder(name);
    write_exr(&folder.join("a.exr"), &picture(40, 32));
    write_exr(&folder.join("b.exr"), &picture(40, 40));
    write_exr(&folder.join("wide.exr"), &picture(41, 41));
    fs::write(folder.join("a.pfm"), pfm::encode(&picture(40, 32))).unwrap();
    let mut holes = picture(40, 40);
    holes.rgb[2 * 40 + 7] = [f32::NAN, 0.0, f32::INFINITY];
    write_exr(&folder.join("nan.exr"), &holes);
    fs::write(folder.join("broken.exr"), "not a picture").unwrap();
    let coded = |level: u8, alpha: u8| {
        move |x, _| image::Rgba([level, level, level, if x == 3 { alpha } else { 255 }])
    };
    for (name, level, alpha) in
        [("white.png", 255, 255), ("grey.png", 188, 255), ("glassy.png", 188, 128)]
    {
        image::RgbaImage::from_fn(16, 16, coded(level, alpha)).save(folder.join(name)).unwrap();
    }
    let glassy = SpecificChannels::rgba(|at: exr::prelude::Vec2<usize>| {
        (0.25_f32, 0.25_f32, 0.25_f32, if at.x() == 5 { 0.5_f32 } else { 1.0 })
    });
    Image::from_channels((40, 24), glassy).write().to_file(folder.join("glassy.exr")).unwrap();
    folder
}

fn caustica(folder: &Path, arguments: &[&str]) -> Output {
    support::caustica(folder, &[&["diff"], arguments].concat())
}

#[track_caller]
fn ends(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    let output = support::ends(folder, &[&["diff"], arguments].concat(), code, words);
    if code != 3 {
        assert_eq!(output.stdout.is_empty(), code != 0, "{arguments:?}: {}", text(&output.stdout));
        assert_eq!(output.stderr.is_empty(), code == 0, "{arguments:?}: {}", text(&output.stderr));
    }
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let shown = text(&caustica(folder, &[arguments, &["--json"]].concat()).stdout);
    serde_json::from_str(&shown).unwrap_or_else(|error| panic!("{error}: {shown}"))
}

/// Theory: a fifth of the pixels differs by 0.25, so MSE is 0.0125, PSNR 20 log10(0.25 /
/// sqrt(0.0125)), the mean ratio 1.2, and relMSE without its largest pixel (one of 960) 0.0625 /
/// 0.0725 * 191 / 959.
#[test]
fn figures_are_those_of_the_formulas() {
    let folder = folder("figures");
    let found = json(
        &folder,
        &["a.exr", "b.exr", "--region", "wrong=32,0,40,24", "--region", "right=0,0,8,24"],
    );
    let close = |place: &Value, key: &str, expected: f64| {
        let value = place[key].as_f64().unwrap();
        assert!((value - expected).abs() < 1e-9, "{key}: {value}, expected {expected}");
    };
    let whole = &found["picture"];
    close(whole, "mse", 0.0125);
    close(whole, "rmse", 0.0125_f64.sqrt());
    close(whole, "psnr", 10.0 * (0.0625_f64 / 0.0125).log10());
    close(whole, "rel_mse", 0.0625 / 0.0725 * 191.0 / 959.0);
    assert!((whole["mean_ratio"][1].as_f64().unwrap() - 1.2).abs() < 1e-12);
    assert_eq!((&found["width"], &found["coding"]), (&Value::from(40), &Value::from("radiance")));
    assert_eq!(found["hdr_flip_exposures"]["count"], 2);
    let wrong = &found["regions"]["wrong"];
    close(wrong, "mse", 0.0625);
    assert!(wrong["ldr_flip"].as_f64().unwrap() > whole["ldr_flip"].as_f64().unwrap());
    assert!(wrong["ssim"].as_f64().unwrap() < whole["ssim"].as_f64().unwrap());
    assert_eq!(wrong["rectangle"], serde_json::json!([32, 0, 40, 24]));
    let right = &found["regions"]["right"];
    close(right, "mse", 0.0);
    close(right, "ldr_flip", 0.0);
    assert_eq!((&right["psnr"], &right["mean_ratio"][0]), (&Value::Null, &Value::from(1.0)));
    assert_eq!(found["passed"], serde_json::json!([]));
    // The same figures as text, from another format.
    let shown =
        text(&caustica(&folder, &["a.pfm", "b.exr", "--region", "wrong=32,0,40,24"]).stdout);
    for words in [
        "1.2500e-2",
        "1.200000",
        "wrong: columns 32 to 39, rows 0 to 23",
        "2 exposures",
        "192 of 960",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
}

#[test]
fn thresholds_are_held_one_by_one() {
    let folder = folder("thresholds");
    for (inside, beyond, words) in [
        ("--max-MSE=0.0126", "--max-MSE=0.0124", ["MSE 1.2500e-2", "at most 1.2400e-2"]),
        ("--max-RMSE=0.12", "--max-RMSE=0.11", ["RMSE 1.1180e-1", "at most 1.1000e-1"]),
        ("--max-relMSE=0.18", "--max-relMSE=0.17", ["relMSE 1.7169e-1", "at most 1.7000e-1"]),
        ("--min-PSNR=6.9", "--min-PSNR=7", ["PSNR 6.98", "at least 7.0000e0"]),
        (
            "--max-mean-ratio=0.21",
            "--max-mean-ratio=0.19",
            ["means 2.0000e-1", "at most 1.9000e-1"],
        ),
        ("--max-FLIP=1", "--max-FLIP=0.01", ["LDR-FLIP", "at most 1.0000e-2"]),
        ("--max-HDR-FLIP=1", "--max-HDR-FLIP=0.01", ["HDR-FLIP", "at most 1.0000e-2"]),
        ("--min-SSIM=0.1", "--min-SSIM=0.9999", ["SSIM", "at least 9.9990e-1"]),
    ] {
        ends(&folder, &["a.exr", "b.exr", inside], 0, &[]);
        ends(
            &folder,
            &["a.exr", "b.exr", beyond],
            3,
            &[&["over the threshold"], &words[..]].concat(),
        );
        // Equal images pass the strictest threshold; option names are case-insensitive.
        ends(&folder, &["b.exr", "b.exr", &beyond.to_lowercase()], 0, &[]);
    }
    let strict =
        ["--max-FLIP=0", "--max-HDR-FLIP=0", "--max-MSE=0", "--min-SSIM=1", "--max-mean-ratio=0"];
    ends(&folder, &[&["b.exr", "b.exr"], &strict[..]].concat(), 0, &[]);
    ends(
        &folder,
        &[&["a.exr", "b.exr"], &strict[..]].concat(),
        3,
        &["LDR-FLIP", "HDR-FLIP", "MSE", "SSIM", "means"],
    );
    // A threshold applies to its own region only.
    let regions = ["a.exr", "b.exr", "--region", "left=0,0,20,24", "--region", "right=20,0,40,24"];
    ends(&folder, &[&regions[..], &["--max-MSE", "left=0"]].concat(), 0, &[]);
    ends(
        &folder,
        &[&regions[..], &["--max-MSE", "right=0.02"]].concat(),
        3,
        &["MSE of right 2.5000e-2"],
    );
    let found = json(&folder, &[&regions[..], &["--max-MSE=1", "--max-MSE=right=0.02"]].concat());
    assert_eq!(found["passed"].as_array().unwrap().len(), 1);
    assert_eq!(
        (&found["passed"][0]["measure"], &found["passed"][0]["region"]),
        (&"MSE".into(), &"right".into())
    );
}

#[test]
fn pictures_that_cannot_be_used_are_1() {
    let folder = folder("pictures");
    ends(&folder, &["a.exr", "none.exr"], 1, &["none.exr", "cannot be read"]);
    ends(&folder, &["broken.exr", "b.exr"], 1, &["broken.exr", "not a readable image"]);
    ends(&folder, &["a.exr", "wide.exr"], 1, &["40x24 and 41x24", "a.exr", "wide.exr"]);
    ends(
        &folder,
        &["a.exr", "nan.exr"],
        1,
        &["2 values of the second", "column 7, row 2", "nan.exr"],
    );
    ends(&folder, &["nan.exr", "a.exr"], 1, &["2 values of the first", "NaN"]);
    ends(
        &folder,
        &["glassy.png", "grey.png"],
        1,
        &["glassy.png: 16 pixels are not opaque", "column 3, row 0"],
    );
    ends(
        &folder,
        &["glassy.exr", "a.exr"],
        1,
        &["glassy.exr: 24 pixels are not opaque", "background"],
    );
    ends(&folder, &["a.exr", "b.exr", "-o", "no/flip.png"], 1, &["the folder `no` does not exist"]);
}

#[test]
fn wrong_use_is_2() {
    let folder = folder("use");
    ends(&folder, &["a.exr"], 2, &["<B>"]);
    ends(&folder, &["a.exr", "b.gif"], 2, &["b.gif", ".exr, .pfm, .hdr, .png or .jpg"]);
    ends(
        &folder,
        &["a.exr", "grey.png"],
        2,
        &["a.exr contains radiance", "grey.png display values"],
    );
    for region in ["x", "x=1,2,3", "=0,0,1,1", "x=4,0,4,9", "x=-1,0,4,9", "x=0,0,1.5,9"] {
        ends(
            &folder,
            &["a.exr", "b.exr", "--region", region],
            2,
            &["four whole numbers", "caustic=290"],
        );
    }
    let region = ["a.exr", "b.exr", "--region", "x=0,0,41,9"];
    ends(&folder, &region, 2, &["region x", "columns 0 to 40", "40 columns and 24 rows"]);
    ends(
        &folder,
        &["a.exr", "b.exr", "--region=x=0,0,4,4", "--region=x=4,4,8,8"],
        2,
        &["two regions are called `x`"],
    );
    ends(
        &folder,
        &["a.exr", "b.exr", "--max-FLIP=y=0.1"],
        2,
        &["the region `y` is not defined", "--region y="],
    );
    ends(
        &folder,
        &["a.exr", "b.exr", "--region=x=0,0,4,4", "--max-FLIP=y=0.1"],
        2,
        &["the regions are x"],
    );
    ends(&folder, &["a.exr", "b.exr", "--max-FLIP", "-1"], 2, &["zero or more"]);
    ends(&folder, &["a.exr", "b.exr", "--max-FLIP", "nan"], 2, &["caustic=0.1"]);
    ends(&folder, &["a.exr", "b.exr", "--min-SSIM", "1.5"], 2, &["-1 to 1"]);
    ends(
        &folder,
        &["a.exr", "b.exr", "--region=x=0,0,5,5", "--min-SSIM=x=0.5"],
        2,
        &["SSIM is not defined for the region x", "11 x 11"],
    );
    ends(
        &folder,
        &["grey.png", "white.png", "--max-HDR-FLIP", "0.5"],
        2,
        &["HDR-FLIP is not defined", "--max-FLIP"],
    );
    ends(
        &folder,
        &["grey.png", "white.png", "--hdr-map", "m.png"],
        2,
        &["HDR-FLIP is not defined"],
    );
    ends(&folder, &["a.exr", "b.exr", "-o", "flip.exr"], 2, &["flip.exr", ".png"]);
    ends(
        &folder,
        &["a.exr", "b.exr", "-o", "m.png", "--hdr-map", "m.png"],
        2,
        &["m.png", "more than once"],
    );
    ends(&folder, &["grey.png", "white.png", "-o", "./grey.png"], 2, &["would overwrite"]);
    assert!(read_any(&folder.join("grey.png")).is_ok(), "the inputs are untouched");
    assert!(!folder.join("m.png").exists());
}

/// Theory: by the sRGB curve 188/255 is 0.5029 of the light of white. Sixteen bits are decoded by
/// the same curve.
#[test]
fn pictures_for_a_display_are_decoded() {
    let folder = folder("display");
    let found = json(&folder, &["grey.png", "white.png"]);
    let light = ((188.0_f64 / 255.0 + 0.055) / 1.055).powf(2.4);
    let ratio = found["picture"]["mean_ratio"][0].as_f64().unwrap();
    assert!((ratio - light).abs() < 1e-6 && (light - 0.5029).abs() < 1e-4, "{ratio} {light}");
    assert_eq!(
        (&found["picture"]["hdr_flip"], &found["coding"]),
        (&Value::Null, &Value::from("display"))
    );
    assert!(found["picture"]["ldr_flip"].as_f64().unwrap() > 0.1);
    let fine = image::ImageBuffer::from_pixel(16, 16, image::Luma([188_u16 * 257 + 1]));
    fine.save(folder.join("fine.png")).unwrap();
    let (fine, coding) = read_any(&folder.join("fine.png")).unwrap();
    let (coarse, _) = read_any(&folder.join("grey.png")).unwrap();
    assert_eq!(coding, Coding::Display);
    assert!(fine.rgb[0][0] > coarse.rgb[0][0] && fine.rgb[0][0] < coarse.rgb[0][0] + 1e-4);
    assert_eq!(json(&folder, &["white.png", "white.png"])["picture"]["ldr_flip"], 0.0);
}

/// Maps have the size of the images, black where nothing differs and bright where something does.
#[test]
fn maps_show_where() {
    let folder = folder("maps");
    for option in ["-o", "--map", "--hdr-map"] {
        let output = caustica(&folder, &["a.exr", "b.exr", option, "map.png"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stdout).ends_with("\nmap.png\n"));
        let map = image::open(folder.join("map.png")).unwrap().to_rgb8();
        assert_eq!(map.dimensions(), (40, 24));
        assert_eq!(map.get_pixel(2, 12).0, [0, 0, 4], "magma begins there");
        assert!(
            map.get_pixel(38, 12).0.iter().map(|v| u32::from(*v)).sum::<u32>() > 60,
            "{option}"
        );
        fs::remove_file(folder.join("map.png")).unwrap();
    }
}
