//! Groups and instances: what they load as, errors, and limits.

use caustica::low_level::scene::{Allowance, Loaded, SceneErrors, ShapeKind, parse, parse_within};

use crate::support::{HEAD, data, sound};

const HEADER: &str = "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[lights]]\n\
                      type = \"point\"\nposition = [0, 9, 0]\nintensity = 1\n[textures.t]\n\
                      type = \"checker\"\ncolors = [0.1, 0.9]\n[materials.checked]\n\
                      type = \"diffuse\"\nreflectance = \"t\"\n[materials.glass]\n\
                      type = \"glass\"\nior = 1.5\n";
/// A material with a texture on its back.
const SIDES: &str = "[materials.sides]\ntype = \"two_sided\"\nfront = \"m\"\nback = \"checked\"\n";
const CUBE: &str = "type = \"mesh\"\nfile = \"cube.obj\"\nmaterial = \"m\"\n";
const BALL: &str = "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n";

fn loaded(text: &str) -> Result<Loaded, SceneErrors> {
    parse(&data("scene.toml"), format!("{HEAD}{HEADER}{text}").as_bytes())
}

fn kinds(text: &str) -> Vec<ShapeKind> {
    sound(loaded(text)).scene.shapes.into_iter().map(|shape| shape.kind).collect()
}

/// The only error, and the line of the text that it points to.
fn fault(result: Result<Loaded, SceneErrors>) -> (String, usize) {
    let Err(errors) = result else { panic!("no error") };
    let [finding] = &errors.errors[..] else { panic!("{errors:?}") };
    let (line, _) = finding.line_column().expect("no place");
    let before = format!("{HEAD}{HEADER}").lines().count();
    (format!("{} | {}", finding.message(), finding.label()), line - before)
}

/// A body of glass and a lamp in a group are separate shapes for each instance, and meshes are
/// shared; a sphere whose two-sided material has a texture on the back keeps its coordinates.
#[test]
fn shapes_that_instances_write_out() {
    let lamp = "type = \"rectangle\"\norigin = [0, 2, 0]\nu = [1, 0, 0]\nv = [0, 0, 1]\n\
                material = \"m\"\nemission = 3\n";
    let group = format!(
        "[[groups.a.shapes]]\n{CUBE}[[groups.a.shapes]]\n{BALL}material = \"glass\"\n\
         [[groups.a.shapes]]\n{lamp}[[groups.b.instances]]\ngroup = \"a\"\n\
         transform = {{ translate = [3, 0, 0] }}\n[[groups.b.instances]]\ngroup = \"a\"\n\
         [[instances]]\ngroup = \"b\"\n[[instances]]\ngroup = \"b\"\n\
         transform = {{ scale = [1, 1, -2] }}\n"
    );
    let loaded = sound(loaded(&group));
    let [unused] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
    assert!(unused.message().contains("`checked` is not used"), "{}", unused.message());
    let shapes = &loaded.scene.shapes;
    let count = |f: &dyn Fn(&ShapeKind) -> bool| shapes.iter().filter(|s| f(&s.kind)).count();
    assert_eq!(shapes.iter().filter(|shape| shape.is_emitter()).count(), 4);
    assert_eq!(count(&|kind| matches!(kind, ShapeKind::Sphere { .. })), 2);
    // cubes, and the stretched spheres of the second instance
    assert_eq!(count(&|kind| matches!(kind, ShapeKind::Instance { .. })), 4 + 2);
    let turn = "transform = [{ rotate = { axis = [1, 0, 0], degrees = 90 } }]\n";
    for (material, stays) in [("m", true), ("sides", false), ("checked", false)] {
        let kinds = kinds(&format!("{SIDES}[[shapes]]\n{BALL}material = \"{material}\"\n{turn}"));
        assert_eq!(matches!(kinds[0], ShapeKind::Sphere { .. }), stays, "{material}");
    }
}

/// Groups that contain themselves, unknown groups and lamps that a map distorts are errors with a
/// place.
#[test]
fn faults() {
    let instance =
        |group: &str, of: &str| format!("[[groups.{group}.instances]]\ngroup = \"{of}\"\n");
    let place = |group: &str| format!("[[instances]]\ngroup = \"{group}\"\n");
    let glow = format!("[[groups.a.shapes]]\n{BALL}material = \"m\"\nemission = 1\n");
    for (text, message, line) in [
        (instance("a", "a") + &place("a"), "group `a` contains itself |", 1),
        // `a` contains a group that contains itself
        (
            instance("a", "b") + &instance("b", "c") + &instance("c", "b") + &place("a"),
            "contains itself by way of `",
            3,
        ),
        (format!("[[groups.arm.shapes]]\n{CUBE}") + &place("amr"), "did you mean `arm`?", 6),
        (glow + &place("a") + "transform = { scale = [1, 2, 1] }\n", "cannot emit", 9),
        (
            format!("[[groups.a.shapes]]\n{CUBE}")
                + &place("a")
                + "transform = { scale = [1, 0, 1] }\n",
            "is singular",
            7,
        ),
    ] {
        let (found, at) = fault(loaded(&text));
        assert!(found.contains(message), "{found}\n{text}");
        assert_eq!(at, line, "{found}");
    }
}

/// Theory: a chain of groups, each with ten instances of the next, places 10^n shapes; the limits
/// refuse it before it takes memory or time, also where an outer group is not placed. A chain of
/// many groups with one instance each is deep, but not large, and loads.
#[test]
fn towers_of_groups() {
    let tower = |levels: usize, each: usize, shape: &str| {
        let mut text = format!("[[groups.g0.shapes]]\n{shape}");
        for level in 1..levels {
            let below = format!("[[groups.g{level}.instances]]\ngroup = \"g{}\"\n", level - 1);
            text += &below.repeat(each);
        }
        text + &format!("[[instances]]\ngroup = \"g{}\"\n", levels - 1)
    };
    let (found, _) = fault(loaded(&tower(30, 10, CUBE)));
    assert!(found.contains("shapes of instances, but the limit `shapes` leaves"), "{found}");
    let planar = format!("{CUBE}uv = \"planar\"\n");
    let text = format!("{HEAD}{HEADER}{}", tower(4, 10, &planar));
    let allowance = Allowance { triangles: 5000, ..Allowance::default() };
    let (found, _) = fault(parse_within(&data("scene.toml"), text.as_bytes(), &allowance));
    assert!(found.contains("triangles of instances"), "{found}");
    // a profile counts with its curves
    let curves: Vec<_> = (0..1000).map(|k| format!("[[1, {k}], [1, {}]]", k + 1)).collect();
    let curves = curves.join(", ");
    let profile = format!("type = \"revolution\"\nsegments = [{curves}]\nmaterial = \"glass\"\n");
    let (found, _) = fault(loaded(&tower(4, 10, &profile)));
    assert!(found.contains("shapes of instances"), "{found}");
    let kinds = kinds(&tower(2000, 1, CUBE));
    assert_eq!(kinds.len(), 1);
}
