//! Light through instances against the same light without them.

use std::sync::Arc;

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use caustica::low_level::scene::{Group, Scene, Shape, ShapeKind};
use glam::{DAffine3, DVec3};

use super::lab::*;

const RADIUS: f64 = 0.06;

/// A floor under a lamp, and these shapes.
fn text(shapes: &str) -> String {
    let camera = Camera {
        position: DVec3::new(0.0, 2.2, 3.0),
        target: DVec3::new(0.0, 0.3, 0.0),
        fov: 32.0,
        size: 16,
    };
    camera.toml()
        + "[materials.floor]\ntype = \"diffuse\"\nreflectance = 0.6\n[materials.bk]\n\
           type = \"glass\"\nior = 1.5\n\
           absorption = [0.3, 0.3, 0.3]\n[materials.oil]\ntype = \"glass\"\nior = 1.3\n\
           [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3\n\
           material = \"floor\"\n\
           [[shapes]]\ntype = \"rectangle\"\norigin = [-0.4, 2.5, -0.4]\nu = [0.8, 0, 0]\n\
           v = [0, 0, 0.8]\n\
           material = \"floor\"\nemission = 10\n"
        + shapes
}

/// Replaces each sphere by an instance of a unit sphere.
fn instanced(mut scene: Scene) -> Scene {
    for shape in &mut scene.shapes {
        if let ShapeKind::Sphere { center, radius } = shape.kind {
            let unit = ShapeKind::Sphere { center: DVec3::ZERO, radius: 1.0 };
            let group = Arc::new(Group::new(vec![Shape::new(unit, shape.material)]));
            let map =
                DAffine3::from_translation(center) * DAffine3::from_scale(-DVec3::splat(radius));
            shape.kind = ShapeKind::Instance { group, map };
        }
    }
    scene
}

/// Theory: a sphere is the image of the unit sphere under a scale, also a mirrored one. So bodies
/// of glass that overlap cast the same caustics as instances: each is a separate body, with its
/// own rank, whichever method and whichever light.
#[test]
fn glass_casts_the_same_caustic() {
    let bodies = text(
        "[[shapes]]\ntype = \"sphere\"\ncenter = [-0.1, 0.6, 0]\nradius = 0.5\nmaterial = \"bk\"\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0.4, 0.6, 0.1]\nradius = 0.4\n\
         material = \"oil\"\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [-0.1, 0.6, 0]\nradius = 0.2\n\
         material = \"oil\"\n",
    );
    let plain = parse(&bodies);
    let moved = instanced(plain.clone());
    for (method, direct, passes) in [
        (Method::Sppm, Direct::Sampled, 8),
        (Method::Sppm, Direct::Photons, 8),
        (Method::Path, Direct::Sampled, 48),
    ] {
        let settings =
            RenderSettings { method, direct, passes, photons: 1 << 13, ..settings(RADIUS) };
        let runs = |scene: &Scene| Prepared::new(scene, &settings).runs(&settings);
        let name = format!("instanced glass, {method:?} {direct:?}");
        assert_regions(&name, &runs(&plain), &runs(&moved), 0.05);
    }
}

/// Theory: the methods agree on a scene of stretched glass and stretched opaque shapes.
#[test]
fn methods_agree_on_ellipsoids() {
    let shapes = text(
        "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.5\nmaterial = \"bk\"\n\
         transform = [{ scale = [1, 0.5, 1] }, { rotate = { axis = [0, 0, 1], degrees = 20 } }, \
         { translate = [-0.3, 0.6, 0] }]\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.5\nmaterial = \"floor\"\n\
         transform = [{ scale = [0.6, 1, 0.6] }, { translate = [0.7, 0.5, 0.2] }]\n",
    );
    let with = |method, direct, passes| {
        let settings =
            RenderSettings { method, direct, passes, photons: 1 << 13, ..settings(RADIUS) };
        runs(&shapes, &settings)
    };
    let path = with(Method::Path, Direct::Sampled, 64);
    for direct in [Direct::Sampled, Direct::Photons] {
        let photons = with(Method::Sppm, direct, 12);
        let whole = |runs: &Runs| runs.region(|_, _| true);
        assert_same(&format!("ellipsoids, {direct:?}"), whole(&photons), whole(&path), 0.1);
    }
}

/// Groups with a lamp, a body of glass, a mirrored box, a cylinder and a cone, placed twice by a
/// group that is placed once.
const GROUPED: &str = "[materials.mirror]\ntype = \"mirror\"\nreflectance = 0.9\n\
    [[groups.set.shapes]]\nSHELF\n[[groups.set.shapes]]\nCAN\n[[groups.set.shapes]]\nHAT\n\
    [[groups.set.shapes]]\nDROP\n[[groups.set.shapes]]\nLAMP\n\
    [[groups.pair.instances]]\ngroup = \"set\"\ntransform = FIRST\n\
    [[groups.pair.instances]]\ngroup = \"set\"\ntransform = SECOND\n\
    [[instances]]\ngroup = \"pair\"\ntransform = OUTER\n";
const PARTS: [(&str, &str); 5] = [
    (
        "SHELF",
        "type = \"box\"\nmin = [-0.4, 0, -0.1]\nmax = [-0.2, 0.5, 0.3]\nmaterial = \"floor\"",
    ),
    ("CAN", "type = \"cylinder\"\nradius = 0.15\nheight = 0.3\nmaterial = \"floor\""),
    (
        "HAT",
        "type = \"cone\"\nradius = 0.2\np0 = [0.1, 0, 0.4]\np1 = [0.1, 0.3, 0.4]\n\
         material = \"mirror\"",
    ),
    ("DROP", "type = \"sphere\"\ncenter = [0.2, 0.3, -0.3]\nradius = 0.25\nmaterial = \"bk\""),
    (
        "LAMP",
        "type = \"rectangle\"\norigin = [-0.1, 1, -0.1]\nu = [0.2, 0, 0]\nv = [0, 0, 0.2]\n\
         material = \"floor\"\nemission = 8",
    ),
];
const FIRST: &str = "[{ scale = [1, 1.2, 0.9] }, { translate = [-0.4, 0, 0.1] }]";
const SECOND: &str = "[{ scale = [-0.8, 0.8, 0.8] }, { translate = [0.5, 0, 0] }]";
const OUTER: &str = "[{ rotate = { axis = [0, 1, 0], degrees = 30 } }]";

/// Theory: an instance shows the same as its shapes, each moved by the maps of the groups around
/// it, inner ones first; lamps and bodies of glass as well. And photons, shadow rays and paths
/// agree.
#[test]
fn groups_render_as_shapes_written_out() {
    let mut grouped = GROUPED.to_owned();
    let mut written = "[materials.mirror]\ntype = \"mirror\"\nreflectance = 0.9\n".to_owned();
    for (name, part) in PARTS {
        grouped = grouped.replace(name, part);
        for own in [FIRST, SECOND] {
            let steps = [own, OUTER].map(|steps| &steps[1..steps.len() - 1]).join(", ");
            written += &format!("[[shapes]]\n{part}\ntransform = [{steps}]\n");
        }
    }
    for (name, map) in [("FIRST", FIRST), ("SECOND", SECOND), ("OUTER", OUTER)] {
        grouped = grouped.replace(name, map);
    }
    // a radius at which the bias of the gather at the edges of small shapes is below the noise
    let with = |shapes: &str, method, direct, passes| {
        let settings =
            RenderSettings { method, direct, passes, photons: 1 << 13, ..settings(0.01) };
        runs(&text(shapes), &settings)
    };
    let path = with(&grouped, Method::Path, Direct::Sampled, 96);
    let plain = with(&written, Method::Path, Direct::Sampled, 96);
    assert_regions("a group and its shapes", &path, &plain, 0.05);
    for direct in [Direct::Sampled, Direct::Photons] {
        let photons = with(&grouped, Method::Sppm, direct, 16);
        let whole = |runs: &Runs| runs.region(|_, _| true);
        assert_same(&format!("groups, {direct:?}"), whole(&photons), whole(&path), 0.1);
    }
}
