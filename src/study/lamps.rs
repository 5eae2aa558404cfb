//! Scaling of lamps at equal power, for studies of the cost of small lamps.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::scene::{Light, Scene, ShapeKind};

/// Total size of the lamps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lamp {
    /// Total area in square scene units.
    Area(f64),
    /// Point lights in place of spheres.
    Point,
}

impl FromStr for Lamp {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<f64>()) {
            ("point", _) => Ok(Self::Point),
            (_, Ok(area)) if (1e-12..=1e12).contains(&area) => Ok(Self::Area(area)),
            _ => Err("expected an area from 1e-12 to 1e12 square scene units, or point".to_owned()),
        }
    }
}

impl fmt::Display for Lamp {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Area(area) => write!(f, "{area:e}"),
            Self::Point => write!(f, "point"),
        }
    }
}

/// Resizes the lamps of a scene: each is scaled about its center, and its radiance is changed to
/// keep its power. A sphere is replaced by a point light with its intensity `pi r^2 L`.
///
/// # Errors
/// A message, if the scene has no area lights, or a lamp cannot be scaled or replaced by a point.
pub fn with_lamp(scene: &Scene, lamp: Lamp) -> Result<Scene, String> {
    let areas =
        scene.shapes.iter().filter(|shape| shape.is_emitter()).map(|shape| area(&shape.kind));
    let total = areas
        .sum::<Option<f64>>()
        .ok_or("lamps that are meshes, planes or surfaces of revolution cannot be resized")?;
    if total <= 0.0 {
        return Err("the scene has no area light".to_owned());
    }
    let mut scene = scene.clone();
    match lamp {
        Lamp::Area(wanted) => {
            let factor = (wanted / total).sqrt();
            for shape in scene.shapes.iter_mut().filter(|shape| shape.is_emitter()) {
                scale(&mut shape.kind, factor);
                shape.emission = shape.emission.map(|radiance| radiance / factor.powi(2));
            }
        }
        Lamp::Point => {
            let mut points = Vec::new();
            for shape in scene.shapes.iter().filter(|shape| shape.is_emitter()) {
                let ShapeKind::Sphere { center, radius } = shape.kind else {
                    return Err("only spherical lamps can become points".to_owned());
                };
                let intensity = shape.emission.map(|radiance| radiance * PI * radius.powi(2));
                points.push(Light::Point { position: center, intensity });
            }
            scene.shapes.retain(|shape| !shape.is_emitter());
            scene.lights.extend(points);
        }
    }
    Ok(scene)
}

fn area(kind: &ShapeKind) -> Option<f64> {
    match kind {
        ShapeKind::Sphere { radius, .. } => Some(4.0 * PI * radius.powi(2)),
        ShapeKind::Disc { radius, .. } => Some(PI * radius.powi(2)),
        ShapeKind::Rectangle { u, v, .. } => Some(u.cross(*v).length()),
        ShapeKind::Cuboid { min, max } => {
            let DVec3 { x, y, z } = *max - *min;
            Some(2.0 * (x * y + y * z + z * x))
        }
        ShapeKind::Plane { .. }
        | ShapeKind::Mesh(_)
        | ShapeKind::Revolution { .. }
        | ShapeKind::Instance { .. } => None,
    }
}

/// Scales a surface that has an [`area`] about its center.
fn scale(kind: &mut ShapeKind, factor: f64) {
    match kind {
        ShapeKind::Sphere { radius, .. } | ShapeKind::Disc { radius, .. } => *radius *= factor,
        ShapeKind::Rectangle { origin, u, v } => {
            *origin += (*u + *v) * (0.5 * (1.0 - factor));
            (*u, *v) = (*u * factor, *v * factor);
        }
        ShapeKind::Cuboid { min, max } => {
            let (middle, half) = ((*min + *max) * 0.5, (*max - *min) * (0.5 * factor));
            (*min, *max) = (middle - half, middle + half);
        }
        ShapeKind::Plane { .. }
        | ShapeKind::Mesh(_)
        | ShapeKind::Revolution { .. }
        | ShapeKind::Instance { .. } => (),
    }
}

/// Theory: power is pi times area times radiance, and a sphere's far field equals that of a point.
#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"
version = 1
[camera]
position = [0.0, 0.0, 5.0]
target = [0.0, 0.0, 0.0]
fov = 40.0
[materials.black]
type = "diffuse"
reflectance = 0.0
[[shapes]]
type = "LAMP"
material = "black"
emission = [2.0, 4.0, 8.0]
"#;

    fn scene(lamp: &str) -> Scene {
        let text = SCENE.replace("type = \"LAMP\"", lamp);
        crate::scene::parse("lamp.toml".as_ref(), text.as_bytes()).unwrap().scene
    }

    fn power(scene: &Scene) -> f64 {
        scene.shapes.iter().map(|shape| area(&shape.kind).unwrap() * shape.emission[1]).sum()
    }

    #[test]
    fn power_stays_and_area_is_as_asked() {
        for lamp in [
            "type = \"sphere\"\ncenter = [1.0, 2.0, 3.0]\nradius = 0.5",
            "type = \"rectangle\"\norigin = [0.0, 1.0, 0.0]\nu = [2.0, 0.0, 0.0]\n\
             v = [0.5, 0.0, 1.0]",
            "type = \"disc\"\ncenter = [1.0, 2.0, 3.0]\nnormal = [0.0, 1.0, 0.0]\nradius = 0.5",
            "type = \"box\"\nmin = [0.0, 0.0, 0.0]\nmax = [1.0, 2.0, 3.0]",
        ] {
            let before = scene(lamp);
            let after = with_lamp(&before, Lamp::Area(1e-4)).unwrap();
            let total: f64 = after.shapes.iter().map(|shape| area(&shape.kind).unwrap()).sum();
            assert!((total / 1e-4 - 1.0).abs() < 1e-12, "{lamp}: {total}");
            assert!((power(&after) / power(&before) - 1.0).abs() < 1e-12, "{lamp}");
            assert!(
                power(&after) / power(&scene(lamp)) < 1.5,
                "the comparison detects a factor of two"
            );
        }
    }

    #[test]
    fn points_have_the_spheres_intensity() {
        let sphere = scene("type = \"sphere\"\ncenter = [1.0, 2.0, 3.0]\nradius = 0.5");
        let point = with_lamp(&sphere, Lamp::Point).unwrap();
        assert!(point.shapes.is_empty());
        let Light::Point { position, intensity } = point.lights[0] else {
            panic!("{:?}", point.lights)
        };
        assert_eq!(position, DVec3::new(1.0, 2.0, 3.0));
        // the power of a point is 4 pi I
        assert!((4.0 * PI * intensity[1] / (PI * power(&sphere)) - 1.0).abs() < 1e-12);
        let disc = scene(
            "type = \"disc\"\ncenter = [1.0, 2.0, 3.0]\nnormal = [0.0, 1.0, 0.0]\nradius = 0.5",
        );
        assert!(with_lamp(&disc, Lamp::Point).is_err());
        assert!(with_lamp(&point, Lamp::Area(1.0)).is_err(), "no area light");
    }
}
