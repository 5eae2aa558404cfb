//! Cylinders and cones: the description that they become, the surface that rays meet, and errors.
//!
//! Theory: a frustum with ends p0 and p1 is the set of points at the distance r(y) from its axis,
//! where y is the height over p0 and r is linear, for y from 0 to |p1 - p0|; caps are discs. Its
//! hits with a ray are the roots of a quadratic equation and two points in planes.

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::surface_at;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::{Loaded, SceneErrors, Shape, ShapeKind, parse};
use caustica::low_level::shapes::ray::Ray;
use glam::DVec3;

use crate::support::HEAD;

const REST: &str = "[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                    [environment]\nradiance = 1\n[[shapes]]\nmaterial = \"m\"\n";

/// Lines before `[[shapes]]`, and that line.
const HEADER_LINES: usize = 11;

fn load(shape: &str) -> Result<Loaded, SceneErrors> {
    parse("scene.toml".as_ref(), format!("{HEAD}{REST}{shape}").as_bytes())
}

fn shape(text: &str) -> Shape {
    load(text).unwrap_or_else(|error| panic!("{text}: {error:?}")).scene.shapes[0].clone()
}

/// With a height they are surfaces of revolution about the local y axis.
#[test]
fn they_are_surfaces_of_revolution() {
    let placed = "transform = { scale = 2, rotate = { axis = [1, 2, 3], degrees = 40 }, translate = [4, 5, 6] }\n\
                  emission = [1, 2, 3]\n";
    for (text, segments) in [
        ("type = \"cylinder\"\nradius = 0.5\nheight = 3\ncaps = false\n", "[[[0.5, 0], [0.5, 3]]]"),
        (
            "type = \"cylinder\"\nradius = 0.5\nheight = 3\n",
            "[[[0, 0], [0.5, 0]], [[0.5, 0], [0.5, 3]], [[0.5, 3], [0, 3]]]",
        ),
        ("type = \"cone\"\nradius = 2\nheight = 3\n", "[[[0, 0], [2, 0]], [[2, 0], [0, 3]]]"),
        ("type = \"cone\"\nradius = 2\nheight = 3\ncaps = false\n", "[[[2, 0], [0, 3]]]"),
        (
            "type = \"cone\"\nradius = 2\ntop_radius = 0.25\nheight = 3\n",
            "[[[0, 0], [2, 0]], [[2, 0], [0.25, 3]], [[0.25, 3], [0, 3]]]",
        ),
    ] {
        let expected = shape(&format!("type = \"revolution\"\nsegments = {segments}\n{placed}"));
        assert_eq!(shape(&format!("{text}{placed}")), expected, "{text}");
    }
}

/// The ends of the axis, before and after a transform, in all directions.
#[test]
fn ends_are_where_they_are_given() {
    let directions = [
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::X,
        DVec3::NEG_Z,
        DVec3::new(1e-9, -1.0, 0.0),
        DVec3::new(0.3, -0.5, 0.7),
    ];
    let p0 = DVec3::new(0.25, -1.5, 3.0);
    for direction in directions {
        let p1 = p0 + 2.5 * direction;
        let ends = format!("p0 = {:?}\np1 = {:?}\n", p0.to_array(), p1.to_array());
        let text = format!("type = \"cone\"\nradius = 1\ntop_radius = 0.5\n{ends}");
        let moved = "transform = { scale = 2, rotate = { axis = [0, 0, 1], degrees = 90 }, translate = [1, 1, 1] }\n";
        let place = |p: DVec3| 2.0 * DVec3::new(-p.y, p.x, p.z) + 1.0;
        for (more, ends) in [("", [p0, p1]), (moved, [place(p0), place(p1)])] {
            let ShapeKind::Revolution { segments, transform, .. } =
                shape(&format!("{text}{more}")).kind
            else {
                panic!("no revolution")
            };
            let height = segments[2][1].y;
            assert!((height - p0.distance(p1)).abs() < 1e-12);
            let found = [0.0, height].map(|y| transform.point(DVec3::new(0.0, y, 0.0)));
            assert!(
                found[0].distance(ends[0]) + found[1].distance(ends[1]) < 1e-12,
                "{found:?}, {ends:?}"
            );
            let rotation = transform.rotation;
            let off = rotation * rotation.transpose() - glam::DMat3::IDENTITY;
            assert!(off.to_cols_array().iter().all(|x| x.abs() < 1e-12), "{direction}");
            assert!((rotation.determinant() - 1.0).abs() < 1e-12, "{direction}");
        }
    }
}

/// A frustum in world space.
struct Frustum {
    ends: [DVec3; 2],
    radii: [f64; 2],
    caps: bool,
}

impl Frustum {
    /// Distance and outward normal of the nearest hit, `None` for a miss; the error is a ray that
    /// passes so close to a rim or the outline that rounding decides.
    fn hit(&self, origin: DVec3, direction: DVec3) -> Result<Option<(f64, DVec3)>, ()> {
        const CLOSE: f64 = 2e-3;
        let [p0, p1] = self.ends;
        let (height, axis) = (p0.distance(p1), (p1 - p0).normalize());
        let q = origin - p0;
        let (y, dy) = (q.dot(axis), direction.dot(axis));
        let slope = (self.radii[1] - self.radii[0]) / height;
        let (across, d) = (q - y * axis, direction - dy * axis);
        let (r, dr) = (self.radii[0] + slope * y, slope * dy);
        let (a, b, c) = (d.dot(d) - dr * dr, across.dot(d) - r * dr, across.dot(across) - r * r);
        let mut hits = Vec::new();
        let root = b * b - a * c;
        if root.abs() < CLOSE || a.abs() < CLOSE {
            return Err(());
        }
        if root > 0.0 {
            for t in [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a] {
                let at = y + t * dy;
                if at.abs() < CLOSE || (at - height).abs() < CLOSE {
                    return Err(());
                }
                if (0.0..height).contains(&at) {
                    let radial = (across + t * d).normalize();
                    hits.push((t, (radial - slope * axis).normalize()));
                }
            }
        }
        for end in 0..2 {
            let t = (end as f64 * height - y) / dy;
            let inside = self.radii[end] - (across + t * d).length();
            if self.caps && inside.abs() < CLOSE || dy.abs() < CLOSE {
                return Err(());
            }
            if self.caps && inside > 0.0 {
                hits.push((t, axis * (2.0 * end as f64 - 1.0)));
            }
        }
        hits.retain(|(t, _)| *t > 0.0);
        Ok(hits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)))
    }
}

#[test]
fn rays_meet_the_surface() {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let ends = [DVec3::new(0.5, 0.25, -0.5), DVec3::new(-0.5, 1.5, 1.0)];
    for (radii, caps) in [
        ([0.5, 0.5], true),
        ([0.5, 0.5], false),
        ([0.75, 0.0], true),
        ([0.75, 0.0], false),
        ([0.75, 0.25], true),
        ([0.2, 0.9], false),
    ] {
        let [p0, p1] = ends.map(|end| end.to_array());
        let kind = if radii[0] == radii[1] {
            "type = \"cylinder\"\n".to_owned()
        } else {
            format!("type = \"cone\"\ntop_radius = {}\n", radii[1])
        };
        let text =
            format!("{kind}radius = {}\np0 = {p0:?}\np1 = {p1:?}\ncaps = {caps}\n", radii[0]);
        let packed = prepare(&load(&text).unwrap().scene, 8, 8).unwrap();
        let frustum = Frustum { ends, radii, caps };
        let (mut clear, mut met) = (0, 0);
        for _ in 0..4000 {
            let mut point = |size: f64| DVec3::from_array([0; 3].map(|_| size * (random() - 0.5)));
            let middle = ends[0].midpoint(ends[1]);
            let (origin, target) = (middle + point(6.0), middle + point(2.5));
            let direction = (target - origin).normalize();
            let Ok(expected) = frustum.hit(origin, direction) else { continue };
            clear += 1;
            let from = (origin - packed.center) / packed.unit;
            let ray = Ray {
                origin: from.as_vec3(),
                t_min: 0.0,
                direction: direction.as_vec3(),
                t_max: 1e30,
            };
            let hit = intersect_scene(&packed.tables, &ray);
            let Some((t, normal)) = expected else {
                assert!(hit.t >= 1e30, "{text}: a hit from {origin} along {direction}");
                continue;
            };
            met += 1;
            let found = f64::from(hit.t) * packed.unit;
            assert!((found - t).abs() < 1e-4, "{text}: {found} and {t} from {origin}, {direction}");
            let surface = surface_at(&packed.tables, &ray, &hit);
            let off = surface.normal.as_dvec3().distance(normal);
            assert!(off < 1e-3, "{text}: {} and {normal}", surface.normal);
        }
        assert!(clear > 3600 && met > 800, "{text}: {clear} clear rays, {met} hits");
    }
}

#[test]
fn wrong_axes_are_reported() {
    for (text, line, expected) in [
        ("", 0, "expected `height`, or `p0` and `p1`"),
        ("p0 = [0, 0, 0]\n", 0, "expected `height`, or `p0` and `p1`"),
        ("height = 1\np0 = [0, 0, 0]\np1 = [0, 1, 0]\n", 5, "expected either `height`, or"),
        ("height = 1\np1 = [0, 1, 0]\n", 5, "expected either `height`, or"),
        ("p0 = [1, 0, 0]\np1 = [1, 0, 0]\n", 5, "expected another end of the axis"),
        ("p0 = [1e15, 0, 0]\np1 = [-1e15, 0, 0]\n", 5, "expected another end of the axis"),
        ("height = 0\n", 4, "greater than 0"),
        ("height = 1e16\n", 4, "at most 1e15"),
        ("height = 1\nradius = 0\n", 4, "greater than 0"),
        ("height = 1\ntop_radius = -1\n", 5, "not below 0"),
    ] {
        let more = if text.contains("radius = 0") { "" } else { "radius = 1\n" };
        let text = format!("type = \"cone\"\n{more}{text}");
        let Err(errors) = load(&text) else { panic!("no error in {text}") };
        let error = &errors.errors[0];
        let lines = error.line_column().unwrap().0 - HEADER_LINES;
        assert!(errors.errors.len() == 1 && error.label().contains(expected), "{text}: {errors:?}");
        assert_eq!(lines, line, "{text}");
    }
}
