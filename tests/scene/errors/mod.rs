//! Errors and warnings in scene files: message and place.

mod jpeg;
mod meshes;
mod mutated;
mod pictures;

use crate::support::{HEAD, data, folder};
use caustica::low_level::scene::{Finding, SceneErrors, load, parse};

fn errors_of(text: &str) -> SceneErrors {
    match parse(&data("scene.toml"), text.as_bytes()) {
        Err(errors) => errors,
        Ok(_) => panic!("no error in\n{text}"),
    }
}

/// Line, column, and a part of the message with its caret's label and its help.
type Expected = (usize, usize, &'static str);

fn reported(finding: &Finding) -> String {
    format!("{} | {} | {}", finding.message(), finding.label(), finding.help().unwrap_or(""))
}

/// Compares findings with the expected ones, in order; describes the difference.
fn differs(found: &[Finding], expected: &[Expected]) -> Option<String> {
    let found: Vec<_> =
        found.iter().map(|finding| (finding.line_column(), reported(finding))).collect();
    let same = found.len() == expected.len()
        && found.iter().zip(expected).all(|((place, text), &(line, column, part))| {
            *place == Some((line, column)) && text.contains(part)
        });
    (!same).then(|| format!("found {found:#?}, expected {expected:#?}"))
}

/// [`HEAD`] has five lines and this three, so a case starts at a known line.
const MATERIAL: &str = "[materials.grey]\ntype = \"diffuse\"\nreflectance = 0.5\n";

/// Each error is reported at its own place with the expected form.
#[test]
fn one_fault_each() {
    let after_head: &[(&str, Expected)] = &[
        ("[flim]\n", (6, 2, "did you mean `film`?")),
        ("[film]\nwidth = \"wide\"\n", (7, 9, "expected a whole number from 1 to 65536")),
        ("[film]\nwidth = 0\n", (7, 9, "out of range")),
        ("[film]\ntonemap = \"agxx\"\n", (7, 11, "did you mean `agx`?")),
        ("aperture = -1\n", (6, 12, "not below 0")),
        ("aperture = 0.1\n", (6, 12, "`focus` is missing")),
        ("up = [0, 0, 1]\n", (6, 6, "parallel to the view")),
        ("up = [0, 0, 0]\n", (6, 6, "length 0")),
        ("up = [0, nan, 0]\n", (6, 10, "expected a finite number")),
        ("up = [0, -inf, 0]\n", (6, 10, "expected a finite number")),
        ("up = [0, 1e999, 0]\n", (6, 10, "not a finite number")),
        ("up = [0, 1]\n", (6, 6, "expected an array of 3 numbers")),
        ("fov_axis = \"diag\"\n", (6, 12, "expected \"vertical\" or \"horizontal\"")),
        ("focal_length = 50\n", (6, 16, "exclude each other")),
        ("sensor = 24\n", (6, 10, "`sensor` without `focal_length`")),
        ("shift = [0, 17]\n", (6, 13, "from -16 to 16")),
        ("size = 3\n", (6, 1, "unknown key `size` in camera")),
        ("type = \"fish\"\n", (6, 8, "did you mean `fisheye`? | known types: `perspective`, ")),
        ("type = \"panorama\"\n", (5, 1, "unknown key `fov` in camera (panorama)")),
        ("type = \"fisheye\"\naperture = 0.1\n", (7, 1, "unknown key `aperture`")),
        ("[film]\nfilter = \"gaus\"\n", (7, 10, "or \"tent\" or \"gaussian\" or \"mitchell\"")),
        ("[film]\nfilter = 3\n", (7, 10, "`film.filter` is a")),
        ("[film]\nfilter = { type = \"tent\", radius = 0 }\n", (7, 36, "from 0.05 to 16")),
        ("[film]\nfilter = { type = \"tent\", sigma = 1 }\n", (7, 27, "unknown key `sigma`")),
        ("[film]\nfilter = { radius = 1 }\n", (7, 10, "`type` is missing in film.filter")),
        ("[render]\npasses = 0\n", (7, 10, "at least 1")),
        ("[render]\nphotons = 5_000_000_000\n", (7, 11, "out of range")),
        ("[render]\nalpha = 1.5\n", (7, 9, "greater than 0 and at most 1")),
        ("[render]\nradius = { pixels = -2 }\n", (7, 21, "from 1e-15 to 1e15")),
        ("[render]\neye_samples = 0\n", (7, 15, "from 1 to 65536")),
        ("[render]\nmax_bounces = 70_000\n", (7, 15, "from 0 to 65535")),
        ("[render]\nradius = \"aut\"\n", (7, 10, "did you mean `auto`?")),
        ("[render]\nradius = { pixel = 2 }\n", (7, 10, "{ pixels = ... } or { units = ... }")),
        ("[render]\nmethod = \"bdpt\"\n", (7, 10, "expected \"sppm\" or \"ppm\" or \"path\"")),
        ("[materials.a]\ntype = \"difuse\"\n", (7, 8, "did you mean `diffuse`?")),
        ("[materials.a]\nreflectance = 1\n", (6, 1, "`type` is missing")),
        ("[materials.a]\ntype = \"diffuse\"\nreflectance = 1.5\n", (8, 15, "from 0 to 1")),
        ("[materials.a]\ntype = \"glass\"\nior = 0\n", (8, 7, "greater than 0")),
        (
            "[materials.a]\ntype = \"glass\"\nior = 1.5\nabsorption = [0, -1, 0]\n",
            (9, 18, "not below 0"),
        ),
        (
            "[materials.a]\ntype = \"metal\"\nreflectance = 1\nroughness = 2\n",
            (9, 13, "from 0 to 1"),
        ),
        (
            "[materials.a]\ntype = \"diffuse\"\nreflectance = \"wood\"\n",
            (8, 15, "define it: [textures.wood]"),
        ),
        (
            "[textures.a]\ntype = \"image\"\nfile = \"reference/grd.png\"\n",
            (8, 8, "did you mean grid.png?"),
        ),
        (
            "[textures.a]\ntype = \"image\"\nfile = \"cube.obj\"\n",
            (8, 8, "expected a png, jpg, hdr or exr file"),
        ),
        (
            "[textures.a]\ntype = \"planks\"\nfile = \"reference/grid.png\"\nsize = [0, 1]\n",
            (9, 9, "greater than 0"),
        ),
        (
            "[[lights]]\ntype = \"sun\"\ndirection = [0, 0, 0]\nirradiance = 1\n",
            (8, 13, "no direction"),
        ),
        (
            "[[lights]]\ntype = \"spot\"\nposition = [0, 0, 0]\ntarget = [0, 0, 0]\n\
             intensity = 1\nangle = 20\n",
            (9, 10, "is its position"),
        ),
        (
            "[[lights]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = -1\n",
            (9, 13, "not below 0"),
        ),
        ("[lights]\ntype = \"point\"\n", (6, 1, "write [[lights]] with two brackets")),
        ("[environment]\n", (6, 1, "neither `radiance` nor `file`")),
        ("[environment]\nradiance = 1\nrotate = 3\n", (8, 10, "no meaning without a `file`")),
        ("[environment]\nfile = \"sky.exr\"\n", (7, 8, "cannot read image")),
        (
            "[environment]\nfile = \"sky.exr\"\nrotate = { axis = [0, 0, 0], degrees = 1 }\n",
            (8, 19, "no direction"),
        ),
        (
            "[environment]\nfile = \"sky.exr\"\nrotate = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]\n",
            (8, 10, "is not a rotation | expected three perpendicular rows"),
        ),
        (
            "[environment]\nfile = \"sky.exr\"\nrotate = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]\n",
            (8, 10, "is not a rotation"),
        ),
        (
            "[environment]\nfile = \"sky.exr\"\nrotate = [[1, 0, 0], [0, 1, 0]]\n",
            (8, 10, "expected"),
        ),
        (
            "[[lights]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = 1\nangle = 1e-4\n",
            (10, 9, "too narrow for single precision | expected 0, or at least 0.001"),
        ),
        (
            "[[lights]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = 1\nangle = 181\n",
            (10, 9, "from 0 to 180"),
        ),
        ("fov = 3\n", (6, 1, "duplicate key")),
        ("[film\n", (6, 6, "not TOML")),
    ];
    let wrong = after_head.iter().filter_map(|&(text, expected)| {
        differs(&errors_of(&format!("{HEAD}{text}")).errors, &[expected])
    });
    assert_eq!(wrong.collect::<Vec<_>>().join("\n"), "");
}

/// Numbers that f32 cannot represent once the scene is scaled: lengths above 1e15 or, where 0 is
/// not allowed, below 1e-15; light above 1e30. The bounds themselves pass.
#[test]
fn numbers_beyond_single_precision() {
    let cases: &[(&str, Expected)] = &[
        (
            "up = [0, 1.1e15, 0]\n",
            (6, 10, "too large for single precision | expected at most 1e15"),
        ),
        ("up = [0, -1e300, 0]\n", (6, 10, "too large")),
        ("up = [0, 10_000_000_000_000_000, 0]\n", (6, 10, "too large")),
        ("aperture = 1e16\nfocus = 1\n", (6, 12, "too large")),
        ("focus = 1e-16\n", (6, 9, "too small for single precision | expected at least 1e-15")),
        ("[render]\nradius = { units = 1e-16 }\n", (7, 20, "from 1e-15 to 1e15")),
        ("[render]\nradius = { units = 1e16 }\n", (7, 20, "too large")),
        ("[environment]\nradiance = [1, 2e30, 1]\n", (7, 16, "expected at most 1e30")),
        (
            "[[lights]]\ntype = \"point\"\nposition = [0, 0, 1e31]\nintensity = 1\n",
            (8, 19, "expected at most 1e15"),
        ),
    ];
    let wrong = cases.iter().filter_map(|&(text, expected)| {
        differs(&errors_of(&format!("{HEAD}{text}")).errors, &[expected])
    });
    assert_eq!(wrong.collect::<Vec<_>>().join("\n"), "");
    let shapes: &[(&str, Expected)] = &[
        (
            "type = \"rectangle\"\norigin = [0, 0, 0]\nu = [1e-20, 0, 0]\nv = [0, 1e-20, 0]",
            (14, 5, "has no area"),
        ),
        ("type = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1e-16]", (13, 7, "is empty")),
        (
            "type = \"mesh\"\nfile = \"cube.obj\"\n\
             transform = { scale = 1e15, translate = [1e15, 0, 0] }",
            (13, 13, "reaches to 2.0e15"),
        ),
        (
            "type = \"revolution\"\nprofile = [[1e8, 0], [1e8, 1]]\ntransform = { scale = 1e8 }",
            (13, 13, "reaches to 1.0e16"),
        ),
    ];
    let wrong = shapes.iter().filter_map(|&(text, expected)| {
        let text = format!("{HEAD}{MATERIAL}[[shapes]]\nmaterial = \"grey\"\n{text}\n");
        differs(&errors_of(&text).errors, &[expected])
    });
    assert_eq!(wrong.collect::<Vec<_>>().join("\n"), "");
    let bounds = format!(
        "{HEAD}up = [0, 1e15, 0]\nfocus = 1e-15\n[environment]\nradiance = 1e30\n[render]\n\
         seed = 9223372036854775807\n"
    );
    assert!(parse(&data("scene.toml"), bounds.as_bytes()).is_ok());
    let folder = folder("large");
    std::fs::write(folder.join("far.obj"), "v 0 0 0\nv 1e16 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let text = format!(
        "{HEAD}{MATERIAL}[[shapes]]\ntype = \"mesh\"\nfile = \"far.obj\"\nmaterial = \"grey\"\n"
    );
    let errors = parse(&folder.join("scene.toml"), text.as_bytes()).unwrap_err().errors;
    assert_eq!(differs(&errors, &[(2, 3, "`1e16` is too large")]), None);
}

/// One value is reported once, by the first failing check. Several missing keys of a table, and
/// several errors in one word of a mesh, are each reported.
#[test]
fn one_report_for_a_value() {
    let plane = "[[shapes]]\ntype = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
                 material = \"grey\"\nemission = -1\n";
    let errors = errors_of(&format!("{HEAD}{MATERIAL}{plane}")).errors;
    assert_eq!(differs(&errors, &[(14, 12, "not below 0")]), None);
    let errors = errors_of(&format!("{HEAD}[render]\nalpha = 1e20\n")).errors;
    assert_eq!(differs(&errors, &[(7, 9, "too large")]), None);
    let errors = errors_of("version = 1\n[camera]\nfov = 30\n").errors;
    assert_eq!(
        differs(&errors, &[(2, 1, "`position` is missing"), (2, 1, "`target` is missing")]),
        None
    );

    let folder = folder("twice");
    std::fs::write(folder.join("bad.obj"), "v 0 0 0\nvt 0 0\nf 1 2/3 1\n").unwrap();
    let mesh = "[[shapes]]\ntype = \"mesh\"\nfile = \"bad.obj\"\nmaterial = \"grey\"\n";
    let once = format!("{HEAD}{MATERIAL}{mesh}");
    let [once, twice] = [once.clone(), format!("{once}{mesh}")]
        .map(|text| parse(&folder.join("scene.toml"), text.as_bytes()).unwrap_err().errors);
    assert!(!once.is_empty());
    let all_reported = |errors: &[Finding]| errors.iter().map(reported).collect::<Vec<_>>();
    assert_eq!(all_reported(&once), all_reported(&twice));
}

/// The same for a shape that starts at line 9.
#[test]
fn one_fault_in_a_shape() {
    let shapes: &[(&str, Expected)] = &[
        (
            "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = -1\nmaterial = \"grey\"",
            (12, 10, "greater than 0"),
        ),
        (
            "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0\nmaterial = \"grey\"\nemission = 4",
            (12, 10, "greater than 0"),
        ),
        ("type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1", (9, 1, "`material` is missing")),
        (
            "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"gray\"",
            (13, 12, "did you mean `grey`?"),
        ),
        (
            "type = \"sphere\"\ncenter = [0, 0, 0]\nraduis = 1\nradius = 1\nmaterial = \"grey\"",
            (12, 1, "did you mean `radius`?"),
        ),
        (
            "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"grey\"\n\
             uv = \"planer\"",
            (14, 6, "did you mean `planar`?"),
        ),
        (
            "type = \"rectangle\"\norigin = [0, 0, 0]\nu = [1, 0, 0]\nv = [2, 0, 0]\n\
             material = \"grey\"",
            (13, 5, "no area"),
        ),
        (
            "type = \"rectangle\"\norigin = [0, 0, 0]\nu = [0, 0, 0]\nv = [2, 0, 0]\n\
             material = \"grey\"",
            (13, 5, "no area"),
        ),
        (
            "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 0]\nradius = 1\n\
             material = \"grey\"",
            (12, 10, "no direction"),
        ),
        (
            "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = \"grey\"\n\
             emission = 1",
            (14, 12, "cannot emit"),
        ),
        (
            "type = \"box\"\nmin = [0, 0, 0]\nmax = [1, 0, 1]\nmaterial = \"grey\"",
            (12, 7, "expected y greater than 0"),
        ),
        (
            "type = \"mesh\"\nfile = \"cub.obj\"\nmaterial = \"grey\"",
            (11, 8, "did you mean cube.obj?"),
        ),
        (
            "type = \"mesh\"\nfile = \"cube.obj\"\nmaterial = \"grey\"\ntransform = { scale = 0 }",
            (13, 23, "greater than 0"),
        ),
        (
            "type = \"mesh\"\nfile = \"cube.obj\"\nmaterial = \"grey\"\n\
             transform = { rotate = { axis = [0, 0, 0], degrees = 3 } }",
            (13, 33, "no direction"),
        ),
        ("type = \"revolution\"\nmaterial = \"grey\"", (9, 1, "neither `profile` nor `segments`")),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\nprofile = [[1, 0], [1, 1]]\n\
             segments = [[[1, 0], [1, 1]]]",
            (13, 12, "has both"),
        ),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\nprofile = [[1, 0]]",
            (12, 11, "has 1 element"),
        ),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\nprofile = [[0, 0], [0, 1]]",
            (12, 11, "lies on the axis"),
        ),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\nprofile = [[1, 1], [1, 1]]",
            (12, 11, "single point"),
        ),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\nprofile = [[1, 0], [-3, 1], [1, 2]]",
            (12, 20, "crosses the axis"),
        ),
        (
            "type = \"revolution\"\nmaterial = \"grey\"\n\
             segments = [[[1, 0], [1, 1]], [[1, 2], [1, 3]]]",
            (12, 32, "expected [1, 1]"),
        ),
    ];
    let wrong = shapes.iter().filter_map(|&(text, expected)| {
        let text = format!("{HEAD}{MATERIAL}[[shapes]]\n{text}\n");
        differs(&errors_of(&text).errors, &[expected])
    });
    assert_eq!(wrong.collect::<Vec<_>>().join("\n"), "");
}

/// One file with errors from all stages of checking: all are reported at once, in the order of the
/// file.
#[test]
fn many_faults_at_once() {
    let text = "version = 2\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1]\nfov = 200\n\
                [render]\nalpha = 0.0\npasses = -3\n\
                [materials.glas]\ntype = \"glass\"\nior = -1\n[[shapes]]\ntype = \"sphere\"\n\
                center = [0, nan, 0]\nradius = -1\n\
                colour = 3\nmaterial = \"glass\"\n[[shapes]]\ntype = \"mesh\"\nfile = \"no.obj\"\n\
                material = \"glas\"\n";
    let expected = [
        (1, 11, "expected 1"),
        (4, 10, "expected an array of 3 numbers"),
        (5, 7, "less than 180"),
        (7, 9, "at most 1"),
        (8, 10, "out of range"),
        (11, 7, "greater than 0"),
        (14, 14, "finite"),
        (15, 10, "greater than 0"),
        (16, 1, "unknown key `colour`"),
        (17, 12, "did you mean `glas`?"),
        (20, 8, "cannot read mesh"),
    ];
    assert_eq!(differs(&errors_of(text).errors, &expected), None);
}

/// A camera with neither a field of view nor a focal length, a fisheye with too wide a view, and a
/// focal length that single precision cannot tell from zero.
#[test]
fn cameras_without_a_view() {
    let head = "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\n";
    for (rest, expected) in [
        ("", (2, 1, "`fov` is missing in camera")),
        ("type = \"fisheye\"\nfov = 400\n", (6, 7, "at most 360")),
        ("type = \"fisheye\"\n", (2, 1, "`fov` is missing in camera (fisheye)")),
        ("type = \"orthographic\"\n", (2, 1, "`size` is missing in camera (orthographic)")),
        ("focal_length = 1e-15\nsensor = 1e15\n", (5, 16, "gives a view of 180 degrees")),
    ] {
        assert_eq!(differs(&errors_of(&format!("{head}{rest}")).errors, &[expected]), None);
    }
}

/// The comparison of this file detects a wrong line, a wrong column, a wrong text and a missing
/// error.
#[test]
fn comparator_finds_planted_errors() {
    let errors = errors_of(&format!("{HEAD}[flim]\n")).errors;
    assert_eq!(differs(&errors, &[(6, 2, "film")]), None);
    for planted in [
        &[(7, 2, "film")][..],
        &[(6, 1, "film")],
        &[(6, 2, "foil")],
        &[],
        &[(6, 2, "film"), (6, 2, "film")],
    ] {
        assert!(differs(&errors, planted).is_some(), "{planted:?}");
    }
}

/// Errors inside an OBJ file and its MTL file name that file and its lines.
#[test]
fn faults_of_a_mesh() {
    let text = format!("{HEAD}[[shapes]]\ntype = \"mesh\"\nfile = \"broken.obj\"\n");
    let errors = errors_of(&text).errors;
    let (mtl, obj): (Vec<_>, Vec<_>) =
        errors.into_iter().partition(|error| error.file().ends_with(".mtl"));
    assert!(obj.iter().all(|error| error.file().ends_with("broken.obj")));
    let expected = [
        (4, 5, "not a finite number"),
        (5, 1, "expected 3 numbers"),
        (7, 1, "a face without a material"),
        (8, 8, "did you mean `paint`?"),
        (9, 7, "index of 0"),
        (10, 7, "out of bounds: the file has 4 vertices | expected 1 to 4"),
        (11, 7, "at least -4"),
        (12, 3, "expected v, as before"),
        (13, 1, "a face of 2 corners"),
        (14, 3, "`x` is not an index"),
    ];
    assert_eq!(differs(&obj, &expected), None);
    let expected =
        [(2, 8, "from 0 to 1"), (5, 1, "expected 3 numbers"), (7, 8, "cannot read image")];
    assert_eq!(differs(&mtl, &expected), None);
}

/// A missing file, one that is not text, and a folder.
#[test]
fn unreadable_files() {
    let errors = load(&data("reference/cornel.toml")).unwrap_err();
    assert_eq!(errors.errors[0].help(), Some("did you mean cornell.toml?"));
    assert_eq!(errors.errors[0].line_column(), None);
    assert!(load(&data("reference")).is_err());
    let errors = parse(&data("x.toml"), b"version = 1\n# \xff\n").unwrap_err();
    assert_eq!(differs(&errors.errors, &[(2, 3, "not UTF-8")]), None);
}

/// The printed form: path, line, column, the line itself, the label of the caret.
#[test]
fn printed_form() {
    let mut text = String::new();
    let errors = errors_of(&format!("{HEAD}[flim]\n"));
    let theme = miette::GraphicalTheme::unicode_nocolor();
    miette::GraphicalReportHandler::new_themed(theme).render_report(&mut text, &errors).unwrap();
    for part in
        ["1 error", "scene.toml:6:2", "[flim]", "did you mean `film`?", "known keys: `camera`"]
    {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
}

/// Warnings.
#[test]
fn warnings() {
    let warnings = |text: &str| parse(&data("scene.toml"), text.as_bytes()).unwrap().warnings;
    let found = warnings(&format!("{HEAD}{MATERIAL}"));
    let expected = [(6, 1, "material `grey` is not used"), (1, 1, "no light")];
    assert_eq!(differs(&found, &expected), None);
    let found = warnings(&format!(
        "{HEAD}[[lights]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = 0\n"
    ));
    assert_eq!(differs(&found, &[(9, 13, "emits no light")]), None);
}

/// An alpha channel is ignored, with a warning unless it is 1 throughout.
#[test]
fn alpha_is_told_of() {
    let folder = folder("alpha");
    let save = |name: &str, alpha: u8| {
        let pixel = |x, _| image::Rgba([200, 100, 50, if x == 1 { alpha } else { 255 }]);
        image::ImageBuffer::from_fn(2, 2, pixel).save(folder.join(name)).unwrap();
    };
    save("clear.png", 254);
    save("solid.png", 255);
    let exr = |name: &str, alpha: f32| {
        let pixel = move |x: usize, _| (0.5f32, 0.5f32, 0.5f32, if x == 2 { alpha } else { 1.0 });
        exr::prelude::write_rgba_file(folder.join(name), 3, 2, pixel).unwrap();
    };
    exr("clear.exr", 0.5);
    exr("solid.exr", 1.0);
    exr::prelude::write_rgb_file(folder.join("none.exr"), 3, 2, |_, _| (0.5f32, 0.5f32, 0.5f32))
        .unwrap();
    let warnings = |texture: &str| {
        let text = format!(
            "{HEAD}[textures.t]\ntype = \"image\"\nfile = \"{texture}\"\n[materials.m]\n\
             type = \"diffuse\"\nreflectance = \"t\"\n\
             [[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n\
             emission = 1\n"
        );
        parse(&folder.join("scene.toml"), text.as_bytes()).unwrap().warnings
    };
    for clear in ["clear.png", "clear.exr"] {
        assert_eq!(differs(&warnings(clear), &[(8, 8, "alpha channel")]), None, "{clear}");
    }
    for solid in ["solid.png", "solid.exr", "none.exr"] {
        assert_eq!(differs(&warnings(solid), &[]), None, "{solid}");
    }
    std::fs::write(
        folder.join("leaf.obj"),
        "mtllib leaf.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl leaf\nf 1 2 3\n",
    )
    .unwrap();
    std::fs::write(folder.join("leaf.mtl"), "newmtl leaf\nmap_Kd clear.png\n").unwrap();
    let text = format!(
        "{HEAD}[environment]\nradiance = 1\n[[shapes]]\ntype = \"mesh\"\nfile = \"leaf.obj\"\n"
    );
    let found = parse(&folder.join("scene.toml"), text.as_bytes()).unwrap().warnings;
    assert_eq!(differs(&found, &[(2, 8, "alpha channel of map_Kd")]), None);
}
