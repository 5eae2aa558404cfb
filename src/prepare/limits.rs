//! Warnings about scenes that exceed single precision.
//!
//! Kernels compute in f32, relative to the scene's center and in units of about its size, so
//! coordinates are rounded by 6e-8 of the size. The thresholds are the limits up to which the
//! bounds of docs/stability.md hold.

use crate::prepare::normalize::{Normalization, extent};
use crate::prepare::orientation::faces_inward;
use crate::scene::settings::{Radius, RenderSettings};
use crate::scene::{Finding, Light, MaterialKind, Scene, ShapeKind, Spans};
use glam::DVec3;

/// Minimum gather radius, relative to the scene's radius.
const LEAST_RADIUS: f64 = 1e-6;
/// Minimum width of a shape, relative to the scene's radius.
const LEAST_WIDTH: f64 = 1e-5;
/// Minimum extent of all shapes together, relative to the scene's radius, which includes the
/// camera.
const LEAST_CONTENT: f64 = 1e-4;
/// Maximum radius of a sphere, relative to the scene's radius, for which f64 resolves the position
/// of its surface.
const GREATEST_SPHERE: f64 = 1e9;
/// Maximum distance of the scene from the origin, relative to the scene's radius, for which f64
/// resolves the coordinates in the file.
const GREATEST_SHIFT: f64 = 1e8;
/// Maximum width of a lamp that is sampled by area, relative to its distance from the scene.
const GREATEST_LAMP: f64 = 100.0;
/// Minimum fraction of the scene's power that a 24-bit random number can select.
const LEAST_SHARE: f64 = 6e-8;

/// Warnings about all values of a scene and its settings that are out of range.
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
    /// Radius of the bounding sphere of the scene and the camera.
    size: f64,
    center: DVec3,
}

impl Limits<'_> {
    fn shape_path(&self, index: usize) -> &str {
        self.places.shapes.get(index).map_or("shapes", String::as_str)
    }

    /// Warns if the scene is so far from the origin that f64 rounds its coordinates.
    fn shift(&self) -> Option<Finding> {
        let shift = self.center.length() / self.size;
        (shift > GREATEST_SHIFT).then(|| {
            self.places.warning(
                &["camera.position"],
                format!("the scene's distance from the origin is {shift:.1e} times its radius"),
                format!("expected at most {GREATEST_SHIFT:e}: double precision rounds its shapes"),
            )
        })
    }

    /// Warns if the shapes are tiny compared with their distance from the camera.
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
                    "the camera's distance is {:.1e} times the width of all shapes together",
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
                // the smallest automatic radius is one pixel
                let pixels =
                    if let Radius::Pixels(pixels) = settings.radius { pixels } else { 1.0 };
                let distance = (camera.target - camera.position).length();
                let film = &self.scene.film;
                let radius = pixels * camera.footprint(distance, film.width, film.height);
                (radius, "the gather radius, in pixels at the camera's target,")
            }
        };
        let share = radius / self.size;
        (share < LEAST_RADIUS).then(|| {
            self.places.warning(
                &["render.radius", "camera.fov", "camera.focal_length", "camera.size"],
                format!("{from} is {share:.1e} of the scene's radius"),
                format!(
                    "expected at least {LEAST_RADIUS:e}: photons' positions are rounded by 6e-8"
                ),
            )
        })
    }

    /// Warns if a closed body of glass, or one that emits light, faces inward.
    fn orientation(&self, index: usize) -> Option<Finding> {
        let shape = &self.scene.shapes[index];
        let glass = matches!(self.scene.materials[shape.material].kind, MaterialKind::Glass { .. });
        let does = match (glass, shape.is_emitter()) {
            (true, _) => "the glass is outside",
            (_, true) => "it emits light inward",
            _ => return None,
        };
        let path = self.shape_path(index);
        faces_inward(&shape.kind).then(|| {
            self.places.warning(
                &[
                    &format!("{path}.profile"),
                    &format!("{path}.segments"),
                    &format!("{path}.file"),
                    path,
                ],
                format!("{path} is a closed body that faces inward: {does}"),
                "expected outward: reverse the order of the vertices of each face, or of the \
                 profile's points"
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
                format!("the radius of {path} is {:.1e} times the scene's", radius / self.size),
                format!(
                    "expected at most {GREATEST_SPHERE:e}, or a plane: double precision rounds \
                     the position of its surface"
                ),
            ));
        }
        let (width, key) = width(kind)?;
        let share = width / self.size;
        (share < LEAST_WIDTH).then(|| {
            self.places.warning(
                &[&format!("{path}.{key}"), path],
                format!("the width of {path} is {share:.1e} of the scene's radius"),
                format!(
                    "expected at least {LEAST_WIDTH:e}: single precision rounds positions by 6e-8"
                ),
            )
        })
    }

    /// Warns about lamps that are sampled by area and far wider than the scene, so that nearly all
    /// samples contribute nothing.
    fn lamps(&self) -> Vec<Finding> {
        let lamp = |(index, shape): (usize, &crate::scene::Shape)| {
            let sampled_by_area =
                !matches!(shape.kind, ShapeKind::Sphere { .. } | ShapeKind::Plane { .. });
            let (low, high) =
                extent(&shape.kind).filter(|_| shape.is_emitter() && sampled_by_area)?;
            // distance from the lamp to the camera's target, a point in the scene
            let way = self.scene.camera.target;
            let near = way.clamp(low, high).distance(way).max(f64::MIN_POSITIVE);
            let ratio = low.distance(high) / near.max(1e-2 * self.size);
            let path = self.shape_path(index);
            (ratio > GREATEST_LAMP).then(|| {
                self.places.warning(
                    &[&format!("{path}.emission"), path],
                    format!(
                        "{path} is a lamp whose width is {ratio:.1e} times its distance from the \
                         camera's target"
                    ),
                    format!(
                        "expected at most {GREATEST_LAMP:e}, or an [environment]: area sampling \
                         will be noisy"
                    ),
                )
            })
        };
        self.scene.shapes.iter().enumerate().filter_map(lamp).collect()
    }

    /// Warns about point lights that are too dim to be selected among stronger ones.
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
                    format!(
                        "expected at least {LEAST_SHARE:e}: lights are selected by power with \
                         24-bit numbers"
                    ),
                )
            })
        };
        self.scene.lights.iter().enumerate().filter_map(dim).collect()
    }

    /// Warns about metals and coats whose roughness is clamped.
    fn smooth_metal(&self) -> Vec<Finding> {
        let least = f64::from(crate::materials::microfacet::ALPHA_MIN).sqrt();
        let smooth = |(index, material): (usize, &crate::scene::Material)| {
            let (MaterialKind::Metal { roughness, .. }
            | MaterialKind::Conductor { roughness, .. }
            | MaterialKind::Plastic { roughness, .. }) = material.kind
            else {
                return None;
            };
            let path = self.places.materials.get(index).map_or("materials", String::as_str);
            (roughness > 0.0 && roughness < least).then(|| {
                self.places.warning(
                    &[&format!("{path}.roughness"), path],
                    format!(
                        "{path} has a roughness of {roughness}, which is rendered as {least:.4}"
                    ),
                    "expected more, or 0 for a mirror: single precision cannot represent so sharp a \
                     peak"
                        .to_owned(),
                )
            })
        };
        self.scene.materials.iter().enumerate().filter_map(smooth).collect()
    }
}

/// Smallest relevant width of a shape, and its key in the scene file. The thickness of flat shapes
/// is not relevant.
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
        ShapeKind::Plane { .. } | ShapeKind::Instance { .. } => return None,
    })
}
