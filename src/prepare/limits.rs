//! What single precision cannot hold, told before it is rendered.
//!
//! Kernels count in f32 about the scene's own centre, in units of about its size, and round every
//! coordinate by 6e-8 of that. The thresholds are those up to which the rows of docs/stability.md
//! hold.

use crate::prepare::normalize::{Normalization, extent};
use crate::prepare::orientation::faces_inward;
use crate::scene::settings::{Radius, RenderSettings};
use crate::scene::{Finding, Light, MaterialKind, Scene, ShapeKind, Spans};
use glam::DVec3;

/// Least gather radius, over the scene's radius.
const LEAST_RADIUS: f64 = 1e-6;
/// Least width of a shape, over the scene's radius.
const LEAST_WIDTH: f64 = 1e-5;
/// Least extent of all shapes together, over the scene's radius, to which the camera's distance
/// counts.
const LEAST_CONTENT: f64 = 1e-4;
/// Greatest radius of a sphere, over the scene's radius: beyond it f64 no longer holds where its
/// surface is.
const GREATEST_SPHERE: f64 = 1e9;
/// Greatest distance of the scene from the origin, over the scene's radius, for f64 as it is
/// written in the file.
const GREATEST_SHIFT: f64 = 1e8;
/// Greatest width of a lamp that is sampled by its area, over the distance that it shines over.
const GREATEST_LAMP: f64 = 100.0;
/// Least share of the scene's light that a random number of 24 bits chooses.
const LEAST_SHARE: f64 = 6e-8;

/// Everything of a scene and its settings that is out of range.
pub fn warnings(scene: &Scene, settings: &RenderSettings, places: &Spans) -> Vec<Finding> {
    let n = Normalization::of(scene);
    let limits = Limits { scene, places, size: n.radius, center: n.center };
    let mut found = Vec::new();
    found.extend(limits.shift());
    found.extend(limits.content());
    found.extend(limits.radius(settings));
    found.extend((0..scene.shapes.len()).filter_map(|index| limits.shape(index)));
    found.extend((0..scene.shapes.len()).filter_map(|index| limits.orientation(index)));
    found.extend(limits.lamps());
    found.extend(limits.dim_lights());
    found.extend(limits.smooth_metal());
    found
}

struct Limits<'a> {
    scene: &'a Scene,
    places: &'a Spans,
    /// Radius of the sphere that holds the scene and its camera.
    size: f64,
    center: DVec3,
}

impl Limits<'_> {
    fn shape_path(&self, index: usize) -> &str {
        self.places.shapes.get(index).map_or("shapes", String::as_str)
    }

    /// The scene lies so far out that the file's own numbers are coarse.
    fn shift(&self) -> Option<Finding> {
        let shift = self.center.length() / self.size;
        (shift > GREATEST_SHIFT).then(|| {
            self.places.warning(
                &["camera.position"],
                format!("the scene lies {shift:.1e} times its own radius from the origin"),
                format!("expected at most {GREATEST_SHIFT:e}: f64 numbers round its shapes"),
            )
        })
    }

    /// The camera is so far away that everything it looks at is a speck.
    fn content(&self) -> Option<Finding> {
        let giant = |(a, b): &(DVec3, DVec3)| a.distance(*b) > 64.0 * self.size;
        let boxes = self.scene.shapes.iter().filter_map(|s| extent(&s.kind)).filter(|b| !giant(b));
        let (low, high) = boxes
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (a, b)| {
                (low.min(a), high.max(b))
            });
        let planes = self.scene.shapes.iter().any(|s| matches!(s.kind, ShapeKind::Plane { .. }));
        let share = 0.5 * low.distance(high) / self.size;
        (!planes && low.x <= high.x && share < LEAST_CONTENT).then(|| {
            self.places.warning(
                &["camera.position"],
                format!(
                    "the camera is {:.1e} times as far away as the shapes are wide together",
                    1.0 / share
                ),
                format!(
                    "expected at most {:e}: single precision rounds their surfaces",
                    1.0 / LEAST_CONTENT
                ),
            )
        })
    }

    fn radius(&self, settings: &RenderSettings) -> Option<Finding> {
        let camera = &self.scene.camera;
        let (radius, from) = match settings.radius {
            Radius::Units(units) => (units, "the gather radius"),
            Radius::Auto | Radius::Pixels(_) => {
                // The least that is chosen is one pixel.
                let pixels =
                    if let Radius::Pixels(pixels) = settings.radius { pixels } else { 1.0 };
                let tan = (0.5 * camera.fov_degrees.to_radians()).tan();
                let width = 2.0 * tan / f64::from(self.scene.film.height);
                let radius = pixels * width * (camera.target - camera.position).length();
                (radius, "the gather radius, in pixels at the camera's target,")
            }
        };
        let share = radius / self.size;
        (share < LEAST_RADIUS).then(|| {
            self.places.warning(
                &["render.radius", "camera.fov"],
                format!("{from} is {share:.1e} of the scene's radius"),
                format!(
                    "expected at least {LEAST_RADIUS:e}: photons' positions are rounded by 6e-8"
                ),
            )
        })
    }

    /// A closed body of glass, or one that emits, faces inward.
    fn orientation(&self, index: usize) -> Option<Finding> {
        let shape = &self.scene.shapes[index];
        let glass = matches!(self.scene.materials[shape.material].kind, MaterialKind::Glass { .. });
        let does = match (glass, shape.is_emitter()) {
            (true, _) => "its glass is outside of it",
            (_, true) => "it shines inward",
            _ => return None,
        };
        let path = self.shape_path(index);
        faces_inward(&shape.kind).then(|| {
            self.places.warning(
                &[&format!("{path}.profile"), &format!("{path}.segments"), &format!("{path}.file"), path],
                format!("{path} is a closed body that faces inward: {does}"),
                "expected outward: reverse the order of each face's corners, or of the profile's points"
                    .to_owned(),
            )
        })
    }

    fn shape(&self, index: usize) -> Option<Finding> {
        let kind = &self.scene.shapes[index].kind;
        let path = self.shape_path(index);
        if let ShapeKind::Sphere { radius, .. } = kind
            && *radius > GREATEST_SPHERE * self.size
        {
            return Some(self.places.warning(
                &[&format!("{path}.radius"), path],
                format!("{path} has {:.1e} times the scene's radius", radius / self.size),
                format!("expected at most {GREATEST_SPHERE:e}, or a plane: f64 rounds where its surface is"),
            ));
        }
        let (width, key) = width(kind)?;
        let share = width / self.size;
        (share < LEAST_WIDTH).then(|| {
            self.places.warning(
                &[&format!("{path}.{key}"), path],
                format!("{path} is {share:.1e} of the scene's radius wide"),
                format!(
                    "expected at least {LEAST_WIDTH:e}: single precision rounds its place by 6e-8"
                ),
            )
        })
    }

    /// Lamps sampled by their area that are far wider than the scene: nearly every sample lands
    /// where it does not matter.
    fn lamps(&self) -> Vec<Finding> {
        let lamp = |(index, shape): (usize, &crate::scene::Shape)| {
            let sampled_by_area =
                !matches!(shape.kind, ShapeKind::Sphere { .. } | ShapeKind::Plane { .. });
            let (low, high) =
                extent(&shape.kind).filter(|_| shape.is_emitter() && sampled_by_area)?;
            // what it shines over: the way from it to the camera's target, which lies in the scene
            let way = self.scene.camera.target;
            let near = way.clamp(low, high).distance(way).max(f64::MIN_POSITIVE);
            let ratio = low.distance(high) / near.max(1e-2 * self.size);
            let path = self.shape_path(index);
            (ratio > GREATEST_LAMP).then(|| {
                self.places.warning(
                    &[&format!("{path}.emission"), path],
                    format!("{path} shines, and is {ratio:.1e} times as wide as it is far from the camera's target"),
                    format!("expected at most {GREATEST_LAMP:e}, or an [environment]: it is sampled by its area, and will be noisy"),
                )
            })
        };
        self.scene.shapes.iter().enumerate().filter_map(lamp).collect()
    }

    /// Point lights that no random number chooses beside stronger ones.
    fn dim_lights(&self) -> Vec<Finding> {
        let power = |light: &Light| match light {
            Light::Point { intensity, .. } | Light::Spot { intensity, .. } => {
                Some(intensity.iter().sum::<f64>())
            }
            Light::Sun { .. } => None,
        };
        let strongest = self.scene.lights.iter().filter_map(power).fold(0.0, f64::max);
        let dim = |(index, light): (usize, &Light)| {
            let share = power(light).filter(|p| *p > 0.0)? / strongest;
            let path = format!("lights[{index}]");
            (share < LEAST_SHARE).then(|| {
                self.places.warning(
                    &[&format!("{path}.intensity"), &path],
                    format!("{path} has {share:.1e} of the intensity of the strongest light"),
                    format!("expected at least {LEAST_SHARE:e}: lights are chosen by power, with 24 bits"),
                )
            })
        };
        self.scene.lights.iter().enumerate().filter_map(dim).collect()
    }

    fn smooth_metal(&self) -> Vec<Finding> {
        let least = f64::from(crate::materials::metal::ALPHA_MIN).sqrt();
        let smooth = |(index, material): (usize, &crate::scene::Material)| {
            let MaterialKind::Metal { roughness, .. } = material.kind else { return None };
            let path = self.places.materials.get(index).map_or("materials", String::as_str);
            (roughness < least).then(|| {
                self.places.warning(
                    &[&format!("{path}.roughness"), path],
                    format!("{path} has a roughness of {roughness}, which is rendered as {least:.4}"),
                    "expected more, or type = \"mirror\": single precision cannot hold so sharp a peak"
                        .to_owned(),
                )
            })
        };
        self.scene.materials.iter().enumerate().filter_map(smooth).collect()
    }
}

/// The least width of a shape that matters, and the key that it comes from. A flat shape's
/// thickness does not.
fn width(kind: &ShapeKind) -> Option<(f64, &'static str)> {
    Some(match kind {
        ShapeKind::Sphere { radius, .. } => (2.0 * radius, "radius"),
        ShapeKind::Disc { radius, .. } => (2.0 * radius, "radius"),
        ShapeKind::Rectangle { u, v, .. } => {
            if u.length() < v.length() {
                (u.length(), "u")
            } else {
                (v.length(), "v")
            }
        }
        ShapeKind::Cuboid { min, max } => ((*max - *min).min_element(), "max"),
        ShapeKind::Revolution { segments, transform, .. } => {
            let radius = segments.iter().flatten().map(|p| p.x).fold(0.0, f64::max);
            (2.0 * radius * transform.scale, "profile")
        }
        ShapeKind::Mesh(_) => {
            let (low, high) = extent(kind)?;
            (low.distance(high), "file")
        }
        ShapeKind::Plane { .. } => return None,
    })
}
