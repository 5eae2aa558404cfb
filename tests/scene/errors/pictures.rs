//! Texture images: formats by content, channels of EXR files, JPEG files of several scans, texels
//! near the limits.

use std::path::Path;

use caustica::low_level::scene::{Allowance, Loaded, Missing, SceneErrors, Texels, parse_within};
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};

use super::jpeg::{Sampling, jpeg};
use super::meshes::written;
use super::{HEAD, differs, reported};
use crate::support::folder;

fn read(folder: &Path, file: &str, missing: Missing) -> Result<Loaded, SceneErrors> {
    let text = format!(
        "{HEAD}[textures.t]\ntype = \"image\"\nfile = \"{file}\"\n[materials.m]\n\
         type = \"diffuse\"\n\
         reflectance = \"t\"\n[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n\
         material = \"m\"\n\
         emission = 1\n"
    );
    let allowance = Allowance { missing, ..Allowance::default() };
    parse_within(&folder.join("scene.toml"), text.as_bytes(), &allowance)
}

/// The texels of a texture in linear values, and the warnings.
fn texels(folder: &Path, file: &str) -> (Vec<[f32; 3]>, Vec<String>) {
    let loaded = read(folder, file, Missing::Error).unwrap_or_else(|e| panic!("{file}: {e:?}"));
    let texels = match &loaded.scene.images[0].texels {
        Texels::Float(texels) => texels.clone(),
        Texels::Rgba8 { data, .. } => {
            data.iter().map(|texel| [0, 1, 2].map(|channel| f32::from(texel[channel]))).collect()
        }
    };
    (texels, loaded.warnings.iter().map(reported).collect())
}

/// The error of a texture.
fn refused(folder: &Path, file: &str) -> String {
    let errors = read(folder, file, Missing::Error).unwrap_err().errors;
    assert!(errors.len() == 1 && errors[0].line_column() == Some((8, 8)), "{errors:?}");
    reported(&errors[0])
}

/// A channel's name and its values in two texels.
type Channel = (&'static str, [f32; 2]);

/// A file's name, its channels, and its texels in linear values.
type Case<'c> = (&'c str, &'c [Channel], &'c [[f32; 3]]);

/// An EXR file of 2 x 1 texels: each channel's values.
fn exr(path: &Path, channels: &[Channel]) {
    let list = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(*name, FlatSamples::F32(values.to_vec())));
    Image::from_channels((2, 1), AnyChannels::sort(list.collect())).write().to_file(path).unwrap();
}

/// Theory: the plain R, G, B of a file are its image. Without them it is Y, in gray, and without
/// both the one layer that has either. Nothing else would determine which of several layers is
/// meant.
#[test]
fn channels_of_exr_files() {
    let folder = folder("channels");
    let (r, g, b, y, z) = ([0.25, 1.0], [0.5, 0.0], [0.75, 0.125], [0.375, 0.625], [3.0, 3.0]);
    let color = vec![[0.25, 0.5, 0.75], [1.0, 0.0, 0.125]];
    let gray = vec![[0.375; 3], [0.625; 3]];
    let cases: [Case; 7] = [
        ("rgb", &[("R", r), ("G", g), ("B", b), ("Z", z)], &color),
        ("y", &[("Y", y)], &gray),
        ("yz", &[("Y", y), ("Z", z), ("A", [1.0, 1.0])], &gray),
        ("layer", &[("diffuse.R", r), ("diffuse.G", g), ("diffuse.B", b), ("Z", z)], &color),
        ("nested", &[("a.b.R", r), ("a.b.G", g), ("a.b.B", b)], &color),
        ("gray layer", &[("mask.Y", y)], &gray),
        (
            "main",
            &[("R", r), ("G", g), ("B", b), ("x.R", g), ("x.G", g), ("x.B", g), ("x.Y", y)],
            &color,
        ),
    ];
    for (name, channels, expected) in cases {
        let file = format!("{name}.exr");
        exr(&folder.join(&file), channels);
        assert_eq!(texels(&folder, &file), (expected.to_vec(), vec![]), "{name}");
    }
    exr(&folder.join("z.exr"), &[("Z", z), ("N.X", r)]);
    let text = refused(&folder, "z.exr");
    assert!(text.contains("`N.X`, `Z`"), "{text}");
    let several = [("a.R", r), ("a.G", g), ("a.B", b), ("b.Y", y)];
    exr(&folder.join("several.exr"), &several);
    let text = refused(&folder, "several.exr");
    assert!(
        text.contains("several layers") && text.contains("`a.B`, `a.G`, `a.R`, `b.Y`"),
        "{text}"
    );
}

/// An uncompressed EXR file of luminance and chroma, the latter for every second pixel and line
/// (OpenEXR file layout).
fn luminance_chroma(
    width: i32,
    height: i32,
    origin: i32,
    luminance: impl Fn(i32, i32) -> f32,
) -> Vec<u8> {
    let attribute = |name: &str, kind: &str, value: &[u8]| {
        let length = (value.len() as u32).to_le_bytes();
        [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &length, value].concat()
    };
    let numbers =
        |numbers: &[i32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>();
    let channel = |name: &str, step: i32| {
        [name.as_bytes(), b"\0", &numbers(&[2, 0, step, step])[..]].concat()
    };
    let channels = [channel("BY", 2), channel("RY", 2), channel("Y", 1), vec![0]].concat();
    let window = numbers(&[origin, origin, origin + width - 1, origin + height - 1]);
    let mut file = numbers(&[20_000_630, 2]);
    for (name, kind, value) in [
        ("channels", "chlist", &channels[..]),
        ("compression", "compression", &[0]),
        ("dataWindow", "box2i", &window),
        ("displayWindow", "box2i", &window),
        ("lineOrder", "lineOrder", &[0]),
        ("pixelAspectRatio", "float", &1f32.to_le_bytes()),
        ("screenWindowCenter", "v2f", &[0; 8]),
        ("screenWindowWidth", "float", &1f32.to_le_bytes()),
    ] {
        file.extend(attribute(name, kind, value));
    }
    file.push(0);
    let line = |y: i32| {
        let chroma = if y % 2 == 0 {
            2 * (origin..origin + width).filter(|x| x % 2 == 0).count()
        } else {
            0
        };
        let values = (0..width).map(|x| luminance(x, y - origin));
        (0..chroma).map(|_| 7.0).chain(values).flat_map(f32::to_le_bytes).collect::<Vec<_>>()
    };
    let lines: Vec<_> = (origin..origin + height).map(|y| (y, line(y))).collect();
    let mut at = file.len() + 8 * lines.len();
    for (_, line) in &lines {
        file.extend((at as u64).to_le_bytes());
        at += 8 + line.len();
    }
    for (y, line) in lines {
        file.extend(numbers(&[y, line.len() as i32]));
        file.extend(line);
    }
    file
}

/// Luminance with subsampled chroma loads as gray luminance, with a warning. Other subsampled
/// channels are refused by the header, before pixels are read that do not fit.
#[test]
fn subsampled_exr() {
    let folder = folder("subsampled");
    for (width, height, origin) in [(4, 4, 0), (5, 3, 0), (6, 5, 2), (1, 1, 0)] {
        let luminance = |x: i32, y: i32| (1 + x + 8 * y) as f32 / 64.0;
        std::fs::write(folder.join("yc.exr"), luminance_chroma(width, height, origin, luminance))
            .unwrap();
        let (found, warnings) = texels(&folder, "yc.exr");
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let expected: Vec<_> = places.map(|(x, y)| [luminance(x, y); 3]).collect();
        assert_eq!(found, expected, "{width} x {height} from {origin}");
        assert!(warnings.len() == 1 && warnings[0].contains("BY, RY are not used"), "{warnings:?}");
    }
    let file = folder.join("rgb.exr");
    exr(&file, &[("B", [0.0; 2]), ("G", [0.0; 2]), ("R", [0.5; 2])]);
    let mut bytes = std::fs::read(&file).unwrap();
    // A channel consists of its name, a zero, type, four bytes, and its sampling in x and y.
    let at = bytes.windows(7).position(|part| part == b"chlist\0").unwrap() + 7 + 4 + 2 + 8;
    bytes[at] = 2;
    std::fs::write(&file, bytes).unwrap();
    let text = refused(&folder, "rgb.exr");
    assert!(text.contains("`B` has one value for 2 x 1 pixels") && text.contains("`G`"), "{text}");
}

/// Theory: the content determines the format. Each format under the name of another gives the same
/// image.
#[test]
fn formats_by_content() {
    let folder = folder("content");
    let pixel = image::Rgb([200u8, 100, 50]);
    let picture = image::RgbImage::from_pixel(16, 16, pixel);
    let floats = image::Rgb32FImage::from_pixel(16, 16, image::Rgb([0.5, 0.25, 0.125]));
    picture.save(folder.join("a.png")).unwrap();
    picture.save(folder.join("a.jpg")).unwrap();
    image::DynamicImage::ImageRgb32F(floats).save(folder.join("a.hdr")).unwrap();
    exr(&folder.join("a.exr"), &[("R", [0.5; 2]), ("G", [0.25; 2]), ("B", [0.125; 2])]);
    let hdr = std::fs::read(folder.join("a.hdr")).unwrap();
    let rgbe =
        [b"#?RGBE\n" as &[u8], &hdr[hdr.iter().position(|&byte| byte == b'\n').unwrap() + 1..]];
    std::fs::write(folder.join("a.rgbe"), rgbe.concat()).unwrap();
    for format in ["png", "jpg", "hdr", "exr", "rgbe"] {
        let (expected, _) = texels(&folder, &format!("a.{format}"));
        for name in ["png", "jpg", "hdr", "exr", "dat"] {
            let other = format!("as {format}.{name}");
            std::fs::copy(folder.join(format!("a.{format}")), folder.join(&other)).unwrap();
            assert_eq!(texels(&folder, &other).0, expected, "{other}");
        }
    }
    assert_eq!(texels(&folder, "a.rgbe").0, vec![[0.5, 0.25, 0.125]; 256]);
    for (bytes, part) in [
        (b"" as &[u8], "it is empty"),
        (b"GIF89a", "it is a gif file"),
        (b"hello", "not a supported image"),
    ] {
        std::fs::write(folder.join("b.png"), bytes).unwrap();
        let text = refused(&folder, "b.png");
        assert!(text.contains(part) && text.contains("png, jpg, hdr or exr"), "{text}");
    }
}

/// Theory: reflectance lies in [0, 1], and a float file may miss it by rounding. Such texels are
/// clamped, with one warning for the file that states their number and the worst. Texels further
/// out are an error with its place.
#[test]
fn texels_near_the_limits() {
    let folder = folder("limits");
    let file = folder.join("t.exr");
    let of = |first: f32, second: f32| {
        exr(&file, &[("R", [0.5, first]), ("G", [0.5, second]), ("B", [0.5, 0.5])]);
    };
    for (first, second, expected, part) in [
        (
            -1e-7,
            0.5,
            [0.0, 0.5, 0.5],
            "1 value out of range by rounding, the worst is -1e-7 at texel (1, 0)",
        ),
        (1.000_000_1, 0.5, [1.0, 0.5, 0.5], "1 value out of range by rounding"),
        (1.000_1, -1e-6, [1.0, 0.0, 0.5], "out of range by rounding"),
        (-1e-4, -1e-6, [0.0, 0.0, 0.5], "2 values out of range by rounding, the worst is -0.0001"),
    ] {
        of(first, second);
        let (found, warnings) = texels(&folder, "t.exr");
        assert_eq!(found, [[0.5; 3], expected]);
        assert!(warnings.len() == 1 && warnings[0].contains(part), "{warnings:?}");
    }
    for (value, part) in [
        (3.0, "texel (1, 0) is 3, above 1"),
        (1.01, "texel (1, 0) is 1.01, above 1"),
        (-0.1, "texel (1, 0) is -0.1, negative"),
        (f32::NAN, "texel (1, 0) is NaN, not finite"),
        (f32::INFINITY, "texel (1, 0) is inf, not finite"),
    ] {
        of(value, 0.5);
        let text = refused(&folder, "t.exr");
        assert!(text.contains(part), "{text}");
    }
    // Emitted light may exceed 1.
    let text = format!("{HEAD}[environment]\nfile = \"t.exr\"\n");
    let sky = |first: f32| {
        of(first, 0.5);
        parse_within(&folder.join("scene.toml"), text.as_bytes(), &Allowance::default())
    };
    assert!(sky(3.0).unwrap().warnings.is_empty());
    assert_eq!(
        differs(&sky(-1e-6).unwrap().warnings, &[(7, 8, "1 value out of range by rounding")]),
        None
    );
    assert!(sky(-0.1).is_err());
}

/// The same for numbers in a scene file.
#[test]
fn numbers_near_the_limits() {
    let read = |number: &str| {
        let text = format!("{HEAD}[materials.m]\ntype = \"mirror\"\nreflectance = {number}\n");
        let scene = text
            + "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n\
               emission = 1\n";
        parse_within("scene.toml".as_ref(), scene.as_bytes(), &Allowance::default())
    };
    for (number, inside) in [("1.0000001", 1.0), ("-1e-7", 0.0), ("1.00001", 1.0)] {
        let loaded = read(number).unwrap();
        assert_eq!(
            differs(&loaded.warnings, &[(8, 15, "out of range by rounding")]),
            None,
            "{number}"
        );
        let caustica::low_level::scene::MaterialKind::Mirror { reflectance } =
            loaded.scene.materials[0].kind
        else {
            panic!()
        };
        assert_eq!(
            reflectance,
            caustica::low_level::scene::Reflectance::Color([inside; 3]),
            "{number}"
        );
    }
    for number in ["1.01", "3", "-0.01"] {
        assert_eq!(
            differs(&read(number).unwrap_err().errors, &[(8, 15, "out of range")]),
            None,
            "{number}"
        );
    }
}

/// A missing texture is an error that names the option; with the option it is a warning and gray.
#[test]
fn missing_textures() {
    let folder = written("missing texture", &[("broken.png", b"no picture")]);
    assert!(refused(&folder, "gone.png").contains("--missing warn"));
    let loaded = read(&folder, "gone.png", Missing::Warn).unwrap();
    assert_eq!(differs(&loaded.warnings, &[(8, 8, "gone.png")]), None);
    assert_eq!(loaded.scene.images[0].texels, Texels::Float(vec![[0.5; 3]]));
    assert!(read(&folder, "broken.png", Missing::Warn).is_err());
    // File names in Windows style.
    let folder = written("backslash", &[("tex/t.png", b"")]);
    image::RgbImage::new(1, 1).save(folder.join("tex/t.png")).unwrap();
    assert!(read(&folder, "tex\\\\t.png", Missing::Error).is_ok());
}

/// Theory: the colours of a JPEG file do not depend on how its scans divide the components, nor,
/// away from edges, on the resolution of its chroma. A file is decoded correctly or refused; none
/// is garbled.
#[test]
fn scans_of_jpeg_files() {
    let folder = folder("scans");
    let samplings =
        [Sampling(1, 1), Sampling(2, 2), Sampling(2, 1), Sampling(1, 2), Sampling(4, 1)];
    let together: &[&[usize]] = &[&[0, 1, 2]];
    let split: [&[&[usize]]; 3] = [&[&[0], &[1], &[2]], &[&[0], &[1, 2]], &[&[0, 1], &[2]]];
    let all = || split.into_iter().chain([together]);
    let cases = samplings.iter().flat_map(|&sampling| all().map(move |scans| (sampling, scans)));
    for (is_progressive, (sampling, scans)) in cases.flat_map(|case| [(false, case), (true, case)])
    {
        let (bytes, expected) = jpeg(sampling, scans, is_progressive);
        std::fs::write(folder.join("t.jpg"), bytes).unwrap();
        let name = format!("{sampling:?} {scans:?}, progressive: {is_progressive}");
        let loaded = read(&folder, "t.jpg", Missing::Error);
        if scans.len() > 1 && !is_progressive {
            let text = reported(&loaded.unwrap_err().errors[0]);
            assert!(text.contains("scan"), "{name}: {text}");
            continue;
        }
        let scene = loaded.unwrap_or_else(|e| panic!("{name}: {e:?}")).scene;
        let Texels::Rgba8 { data, .. } = &scene.images[0].texels else { panic!() };
        for (x, y, color) in expected {
            let found = data[y * scene.images[0].width as usize + x];
            let off = (0..3).map(|i| i32::from(found[i]).abs_diff(color[i])).max();
            assert!(off <= Some(3), "{name}: {found:?} at ({x}, {y}), expected {color:?}");
        }
    }
}
