//! Valid scene files: the loaded scene.

use crate::support::{HEAD, data, folder, repository, sound};
use caustica::low_level::scene::{
    Environment, Loaded, MaterialKind, Reflectance, Scene, SceneErrors, ShapeKind, Texels,
    TextureKind, load, parse,
};
use glam::{DVec2, DVec3};

fn reference(name: &str) -> Loaded {
    let path = data("reference").join(name);
    sound(load(&path))
}

fn parse_text(text: &str) -> Result<Loaded, SceneErrors> {
    let path = data("scene.toml");
    parse(&path, text.as_bytes())
}

fn scene_of(text: &str) -> Scene {
    sound(parse_text(text)).scene
}

/// The reference scenes load without a warning, with every name resolved.
#[test]
fn reference_scenes() {
    let cornell = reference("cornell.toml");
    assert!(cornell.warnings.is_empty(), "{:?}", cornell.warnings);
    let scene = &cornell.scene;
    assert_eq!((scene.name.as_str(), scene.film.width, scene.shapes.len()), ("cornell", 512, 8));
    let lamp = scene.shapes.iter().find(|shape| shape.is_emitter()).unwrap();
    assert_eq!(lamp.emission, [25.0; 3]);
    assert_eq!(scene.materials[lamp.material].name, "black");
    assert_eq!(scene.camera.focus, 4.0, "the target's distance");

    let drop = reference("drop.toml");
    assert!(drop.warnings.is_empty(), "{:?}", drop.warnings);
    let segments: Vec<_> = drop
        .scene
        .shapes
        .iter()
        .filter_map(|shape| match &shape.kind {
            ShapeKind::Revolution { segments, .. } => {
                Some(segments.iter().map(Vec::len).collect::<Vec<_>>())
            }
            _ => None,
        })
        .collect();
    assert_eq!(segments, [vec![5], vec![3, 4]]);
    let floor = &drop.scene.materials[drop.scene.shapes[0].material];
    let MaterialKind::Diffuse { reflectance: Reflectance::Texture(tiles), .. } = floor.kind else {
        panic!("{floor:?}")
    };
    assert!(matches!(
        drop.scene.textures[tiles].kind,
        TextureKind::Checker { scale: [12.0, 12.0], .. }
    ));

    let mesh = reference("mesh.toml");
    assert!(mesh.warnings.is_empty(), "{:?}", mesh.warnings);
    assert!(mesh.scene.shapes[0].planar_uv && !mesh.scene.shapes[1].planar_uv);
    assert_eq!(mesh.scene.environment, Some(Environment::Constant { radiance: [0.08, 0.1, 0.14] }));
    let grid = &mesh.scene.images[0];
    assert_eq!((grid.width, grid.height), (64, 64));
    let Texels::Rgba8 { srgb: true, data } = &grid.texels else { panic!() };
    // make_assets.py draws a line of (30, 40, 60) through the corner and an arrow of (250, 250,
    // 250) at row 20.
    assert_eq!((data[0], data[20 * 64 + 10]), ([30, 40, 60, 255], [250, 250, 250, 255]));
}

/// The torus R = 1, r = 0.38 of 48 x 20 quads, scaled by s = 0.5, turned and moved to c: 1920
/// triangles. Every vertex is p = R s w + r s n + c with its own normal n and a unit vector w of
/// the ring, so p - c - r s n has length R s. Faces are wound as their normals point: the closed
/// polyhedron's volume from its winding is positive, and with this many quads within 3 % of 2 pi^2
/// R r^2 s^3.
#[test]
fn torus_of_the_mesh_scene() {
    let scene = reference("mesh.toml").scene;
    let ShapeKind::Mesh(mesh) = &scene.shapes[1].kind else {
        panic!("the second shape is the mesh")
    };
    assert_eq!((mesh.triangles.len(), mesh.uvs.len()), (1920, 49 * 21));
    let centre = DVec3::new(-0.95, 0.62, 0.0);
    let mut volume = 0.0;
    for triangle in &mesh.triangles {
        let p = triangle.position.map(|index| mesh.positions[index as usize] - centre);
        let n = triangle
            .normal
            .expect("the file has normals")
            .map(|index| mesh.normals[index as usize]);
        for corner in 0..3 {
            assert!((n[corner].length() - 1.0).abs() < 1e-12);
            let ring = p[corner] - 0.38 * 0.5 * n[corner];
            assert!((ring.length() - 0.5).abs() < 1e-6, "{ring}");
        }
        volume += p[0].dot(p[1].cross(p[2])) / 6.0;
    }
    let exact = 2.0 * std::f64::consts::PI.powi(2) * 0.38f64.powi(2) * 0.125;
    assert!((volume / exact - 1.0).abs() < 0.03, "{volume} {exact}");
}

/// A rotation by 90 degrees about y takes +z to +x (right-hand rule), after the scale and before
/// the translation.
#[test]
fn transform_order() {
    let scene = scene_of(&format!(
        "{HEAD}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[shapes]]\n\
         type = \"revolution\"\n\
         profile = [[1, 0], [1, 1]]\nmaterial = \"m\"\nemission = 1\n\
         transform = {{ scale = 2, rotate = {{ axis = [0, 3, 0], degrees = 90 }}, translate = [10, 0, 0] }}\n"
    ));
    let ShapeKind::Revolution { transform, .. } = &scene.shapes[0].kind else { panic!() };
    assert!(transform.point(DVec3::Z).distance(DVec3::new(12.0, 0.0, 0.0)) < 1e-12);
    assert!(transform.direction(DVec3::Z).distance(DVec3::X) < 1e-12);
}

/// tests/data/parts.obj contains a red quad, a glowing triangle, a glass triangle, a mirror L-shape
/// (concave hexagon of area 3), a triangle without area, and a line. Each material gives one shape,
/// and triangulation preserves the total area.
#[test]
fn materials_of_an_obj() {
    let loaded =
        parse_text(&format!("{HEAD}[[shapes]]\ntype = \"mesh\"\nfile = \"parts.obj\"\n")).unwrap();
    let scene = loaded.scene;
    let kinds: Vec<_> = scene.shapes.iter().map(|shape| &scene.materials[shape.material]).collect();
    let names: Vec<_> = kinds.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(
        names,
        ["parts.obj:red paint", "parts.obj:lamp", "parts.obj:glass", "parts.obj:chrome"]
    );
    let MaterialKind::Diffuse { reflectance: Reflectance::Texture(texture), .. } = kinds[0].kind
    else {
        panic!()
    };
    assert!(matches!(scene.textures[texture].kind, TextureKind::Image { image: 0, .. }));
    assert_eq!(scene.shapes[1].emission, [5.0, 4.0, 3.0]);
    let water =
        MaterialKind::Glass { ior: 1.33, roughness: 0.0, absorption: [0.0; 3], priority: 0 };
    assert_eq!(kinds[2].kind, water);
    assert_eq!(
        kinds[3].kind,
        MaterialKind::Mirror { reflectance: Reflectance::Color([0.9, 0.8, 0.7]) }
    );
    let areas: Vec<_> = scene
        .shapes
        .iter()
        .map(|shape| {
            let ShapeKind::Mesh(mesh) = &shape.kind else { panic!() };
            let area = |p: [DVec3; 3]| 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length();
            mesh.triangles
                .iter()
                .map(|t| area(t.position.map(|i| mesh.positions[i as usize])))
                .sum::<f64>()
        })
        .collect();
    assert_eq!(areas, [1.0, 0.5, 0.5, 3.0]);
    let warnings: Vec<_> = loaded.warnings.iter().map(|warning| warning.message()).collect();
    assert_eq!(
        warnings,
        ["parts.obj: 1 `l` not used", "parts.obj: 1 triangle without area dropped"]
    );
}

/// A cube without normals: the angle-weighted normal at each corner is the diagonal, however its
/// squares are split (weights by area alone would lean to the faces split at that corner). Flat on
/// request; the quad's uv are kept.
#[test]
fn normals_made_and_refused() {
    let text = |smooth: bool| {
        format!(
            "{HEAD}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[shapes]]\n\
             type = \"mesh\"\n\
         file = \"cube.obj\"\nsmooth = {smooth}\nmaterial = \"m\"\nemission = [1, 2, 3]\n"
        )
    };
    let scene = scene_of(&text(true));
    let ShapeKind::Mesh(mesh) = &scene.shapes[0].kind else { panic!() };
    assert_eq!((mesh.triangles.len(), mesh.positions.len(), mesh.normals.len()), (12, 8, 8));
    for triangle in &mesh.triangles {
        for (p, n) in triangle.position.into_iter().zip(triangle.normal.unwrap()) {
            let diagonal = mesh.positions[p as usize].normalize();
            assert!(mesh.normals[n as usize].distance(diagonal) < 1e-12);
        }
        assert!(triangle.uv.is_some());
    }
    let unit_square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    assert!(
        mesh.uvs.len() == 4 && unit_square.iter().all(|uv| mesh.uvs.contains(uv)),
        "{:?}",
        mesh.uvs
    );
    let flat = scene_of(&text(false));
    let ShapeKind::Mesh(mesh) = &flat.shapes[0].kind else { panic!() };
    assert!(
        mesh.triangles.iter().all(|triangle| triangle.normal.is_none()) && mesh.normals.is_empty()
    );
}

/// A byte-order mark and CRLF change nothing.
#[test]
fn windows_text() {
    let text = format!("{HEAD}[environment]\nradiance = 1\n");
    let plain = scene_of(&text);
    let windows = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_eq!(scene_of(&windows), plain);
    assert_eq!(plain.environment, Some(Environment::Constant { radiance: [1.0; 3] }));
}

/// The keys of `[render]` reach the settings; absent ones keep their defaults.
#[test]
fn render_settings() {
    use caustica::low_level::scene::settings::{Method, Radius, RenderSettings};
    let loaded = parse_text(&format!(
        "{HEAD}[environment]\nradiance = 1\n[render]\nmethod = \"ppm\"\nphotons = 1_000\n\
         radius = {{ units = 0.01 }}\nseed = 0xff\n"
    ))
    .unwrap();
    let expected = RenderSettings {
        method: Method::Ppm,
        photons: 1000,
        radius: Radius::Units(0.01),
        seed: 255,
        ..RenderSettings::default()
    };
    assert_eq!(loaded.settings, expected);
    // A missing radius and the explicit automatic one are both chosen automatically.
    let radius = |render: &str| {
        let text = format!("{HEAD}[environment]\nradiance = 1\n[render]\n{render}\n");
        parse_text(&text).unwrap().settings.radius
    };
    assert_eq!([radius(""), radius("radius = \"auto\"")], [Radius::Auto; 2]);
    assert_eq!(radius("radius = { pixels = 2 }"), Radius::Pixels(2.0));
}

/// The shipped schema for editors equals the one generated from the types.
#[test]
fn schema_is_current() {
    let path = repository("scenes/schema.json");
    let kept = std::fs::read_to_string(path).unwrap().replace("\r\n", "\n");
    assert!(
        kept == caustica::low_level::scene::schema_json(),
        "renew it: cargo run --release --example schema > scenes/schema.json"
    );
}

/// A texture of one channel has that channel's values in all three: colors in the file's encoding,
/// alpha in proportion. A file without the channel is reported.
#[test]
fn channels_of_images() {
    let folder = folder("channels");
    let image = image::ImageBuffer::from_pixel(2, 1, image::Rgba([10u8, 20, 30, 40]));
    image.save(folder.join("leaf.png")).unwrap();
    exr::prelude::write_rgb_file(folder.join("gray.exr"), 1, 1, |_, _| (0.1f32, 0.2f32, 0.3f32))
        .unwrap();
    let load = |file: &str, channel: &str| {
        let text = format!(
            "{HEAD}[textures.a]\ntype = \"image\"\nfile = \"{file}\"\nchannel = \"{channel}\"\n\
             [textures.b]\ntype = \"image\"\nfile = \"{file}\"\n"
        );
        parse(&folder.join("scene.toml"), text.as_bytes())
    };
    for (channel, value, encoded) in
        [("red", 10, true), ("green", 20, true), ("blue", 30, true), ("alpha", 40, false)]
    {
        let scene = load("leaf.png", channel).unwrap().scene;
        assert_eq!(scene.images.len(), 2);
        let Texels::Rgba8 { srgb, data } = &scene.images[0].texels else { panic!() };
        assert_eq!((*srgb, data[0]), (encoded, [value, value, value, 255]), "{channel}");
        let Texels::Rgba8 { srgb: true, data } = &scene.images[1].texels else { panic!() };
        assert_eq!(data[0], [10, 20, 30, 40]);
    }
    let scene = load("gray.exr", "green").unwrap().scene;
    let Texels::Float(texels) = &scene.images[0].texels else { panic!() };
    assert_eq!(texels[0], [0.2; 3]);
    let errors = load("gray.exr", "alpha").unwrap_err();
    let said = (errors.errors[0].message(), errors.errors[0].label());
    assert!(said.0.contains("alpha") && said.1.contains("channel"), "{said:?}");
}

/// Each image format keeps its values: 8-bit as stored, 16-bit through the sRGB curve (or not), hdr
/// and exr in linear floats. The same file in the same colour space is read once.
#[test]
fn image_formats() {
    let folder = folder("images");
    let deep = image::ImageBuffer::from_pixel(2, 1, image::Rgb([32768u16, 0, 65535]));
    deep.save(folder.join("deep.png")).unwrap();
    let floats = image::ImageBuffer::from_fn(3, 2, |x, y| image::Rgb([x as f32, y as f32, 0.5]));
    image::DynamicImage::ImageRgb32F(floats).save(folder.join("sky.hdr")).unwrap();
    exr::prelude::write_rgb_file(folder.join("sky.exr"), 3, 2, |x, y| (x as f32, y as f32, 1e4f32))
        .unwrap();
    let load = |texture: &str, environment: &str| {
        let text = format!(
            "{HEAD}[textures.a]\ntype = \"image\"\nfile = \"deep.png\"\n{texture}\n\
             [textures.b]\ntype = \"planks\"\nfile = \"deep.png\"\nsize = [1, 2]\n\
             [environment]\nfile = \"{environment}\"\nrotate = 90\n"
        );
        parse(&folder.join("scene.toml"), text.as_bytes()).map(|loaded| loaded.scene)
    };
    let exr = load("", "sky.exr").unwrap();
    assert_eq!(exr.images.len(), 2, "deep.png is shared");
    let Texels::Float(texels) = &exr.images[0].texels else { panic!() };
    // IEC 61966-2-1 at 32768/65535: ((0.5000076 + 0.055) / 1.055)^2.4 = 0.214048
    assert!((texels[1][0] - 0.214_048).abs() < 1e-6 && texels[1][1..] == [0.0, 1.0], "{texels:?}");
    let Texels::Float(texels) = &exr.images[1].texels else { panic!() };
    assert_eq!((exr.images[1].width, texels[5]), (3, [2.0, 1.0, 1e4]));
    let environment =
        Environment::Image { image: 1, rotate_degrees: 90.0, tilt: None, scale: [1.0; 3] };
    assert_eq!(exr.environment, Some(environment));

    let hdr = load("color_space = \"linear\"", "sky.hdr").unwrap();
    assert_eq!(hdr.images.len(), 3, "two color spaces of deep.png");
    let Texels::Float(texels) = &hdr.images[0].texels else { panic!() };
    assert!((texels[0][0] - 32768.0 / 65535.0).abs() < 1e-7);
    let Texels::Float(texels) = &hdr.images[2].texels else { panic!() };
    assert_eq!(texels[5], [2.0, 1.0, 0.5]);

    // 1e4 is not a reflectance, and NaN not a radiance.
    let text = format!("{HEAD}[textures.a]\ntype = \"image\"\nfile = \"sky.exr\"\n");
    let errors = parse(&folder.join("scene.toml"), text.as_bytes()).unwrap_err();
    assert!(errors.errors[0].message().contains("is 10000, above 1"));
    exr::prelude::write_rgb_file(folder.join("nan.exr"), 2, 2, |x, _| {
        (x as f32 / 0.0, 0.0f32, 0.0f32)
    })
    .unwrap();
    let errors = load("", "nan.exr").unwrap_err();
    assert!(errors.errors[0].message().contains("texel (0, 0)"), "{errors:?}");
    // A truncated file.
    let bytes = std::fs::read(folder.join("sky.exr")).unwrap();
    std::fs::write(folder.join("cut.exr"), &bytes[..bytes.len() / 2]).unwrap();
    assert!(load("", "cut.exr").is_err());
}
