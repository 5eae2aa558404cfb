//! Interactive camera: orbit, pan, dolly, focus and aperture, as functions from camera to camera.
//!
//! Their results are [`tidy`]: the numbers have few digits, so that a scene file that contains them
//! reproduces the camera exactly.

use glam::{DQuat, DVec3};

use crate::geometry::intersect::intersect_scene;
use crate::math::FAR;
use crate::pack::PackedScene;
use crate::real::Vec4;
use crate::scene::{Camera, Film, Projection};
use crate::tables::NONE;

/// Minimum angle between the view direction and the up vector, in radians.
const LEAST_ANGLE: f64 = 0.01;
/// Significant digits of a camera's numbers, counted from the first digit of its distance.
const DIGITS: i32 = 6;
/// First aperture beyond a pinhole, relative to the focus distance.
const FIRST_APERTURE: f64 = 0.002;

/// Unit vectors to the right, to the top of the image, and along the view direction.
pub fn axes(camera: &Camera) -> [DVec3; 3] {
    let forward = (camera.target - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    [right, right.cross(forward), forward]
}

/// Distance from the lens to the target.
pub fn distance(camera: &Camera) -> f64 {
    camera.target.distance(camera.position)
}

/// Orbits the camera about its target: by `across` radians about the up vector, to the right if
/// positive, and by `over` radians toward the up vector, short of the pole. Keeps the distance and
/// the focus.
pub fn orbit(camera: &Camera, across: f64, over: f64) -> Camera {
    let pole = camera.up.normalize();
    let offset = camera.position - camera.target;
    let from_pole = offset.angle_between(pole);
    let limits = LEAST_ANGLE..=std::f64::consts::PI - LEAST_ANGLE;
    let wanted = (from_pole - over).clamp(*limits.start(), *limits.end());
    let [right, ..] = axes(camera);
    // about the axis to the right, a positive angle leads down, away from the pole
    let risen = DQuat::from_axis_angle(right, wanted - from_pole) * offset;
    let turned = DQuat::from_axis_angle(pole, across) * risen;
    tidy(&Camera { position: camera.target + turned, ..*camera })
}

/// Moves camera and target across the view, so that points at the target's distance, near the view
/// axis, move by `right` and `down`, in image heights.
pub fn pan(camera: &Camera, film: &Film, right: f64, down: f64) -> Camera {
    let [x, y, _] = axes(camera);
    let (width, rows) = (film.width, film.height);
    let height = camera.footprint(distance(camera), width, rows) * f64::from(rows);
    let shift = (y * down - x * right) * height;
    tidy(&Camera { position: camera.position + shift, target: camera.target + shift, ..*camera })
}

/// Multiplies the camera's distance from the target by `factor`. The plane of focus stays in place
/// in the world, or just in front of the lens if the lens has passed it. An orthographic camera
/// changes the size of its image instead, since its distance does not matter.
pub fn dolly(camera: &Camera, factor: f64) -> Camera {
    if let Projection::Orthographic { size, axis } = camera.projection {
        let projection = Projection::Orthographic { size: short(size * factor), axis };
        return Camera { projection, ..*camera };
    }
    let before = distance(camera);
    let position = camera.target + (camera.position - camera.target) * factor;
    let focus = (camera.focus + before * (factor - 1.0)).max(0.01 * before * factor);
    tidy(&Camera { position, focus, ..*camera })
}

/// Focuses on the distance `depth` along the view direction.
pub fn focus(camera: &Camera, depth: f64) -> Camera {
    tidy(&Camera { focus: depth, ..*camera })
}

/// Opens (`factor` above 1) or closes the lens. A pinhole opens to a small aperture, and a smaller
/// aperture than that closes to a pinhole. Panorama and fisheye stay pinholes.
pub fn aperture(camera: &Camera, factor: f64) -> Camera {
    if !camera.has_lens() {
        return *camera;
    }
    let first = FIRST_APERTURE * camera.focus;
    let wanted = camera.aperture * factor;
    let aperture = match factor > 1.0 {
        true => wanted.max(first),
        false if wanted < first => 0.0,
        false => wanted,
    };
    tidy(&Camera { aperture, ..*camera })
}

/// Rounds the camera to six significant digits, counted from the first digit of its distance;
/// aperture and focus are rounded separately. If the focus of a pinhole is close to the target, it
/// becomes the target's distance, which is the default in scene files.
pub fn tidy(camera: &Camera) -> Camera {
    let places = DIGITS - 1 - distance(camera).log10().floor() as i32;
    let point = |p: DVec3| DVec3::from(p.to_array().map(|x| rounded(x, places)));
    let (position, target) = (point(camera.position), point(camera.target));
    let distance = (target - position).length();
    let at_target = camera.aperture == 0.0 && (camera.focus - distance).abs() < 1e-4 * distance;
    let focus = if at_target { distance } else { short(camera.focus) };
    Camera { position, target, aperture: short(camera.aperture), focus, ..*camera }
}

/// Rounds a number to six significant digits.
fn short(x: f64) -> f64 {
    if x > 0.0 { rounded(x, DIGITS - 1 - x.log10().floor() as i32) } else { x }
}

/// Rounds `x` to this number of decimal places; a negative number rounds to tens, hundreds and so
/// on.
fn rounded(x: f64, places: i32) -> f64 {
    let text = match usize::try_from(places) {
        Ok(places) => format!("{x:.places$}"),
        Err(_) => {
            let step = 10f64.powi(-places);
            return (x / step).round() * step;
        }
    };
    // A finite number always parses back. Adding 0 turns -0 into 0.
    text.parse::<f64>().unwrap_or(x) + 0.0
}

/// Depth along the view direction, in units of the scene file, at a position in the image ((0, 0)
/// at the top left, (1, 1) at the bottom right), through the centre of the lens; `None` if the ray
/// hits nothing, or nothing in front of a camera that sees all around.
pub fn depth_at(packed: &PackedScene, x: f64, y: f64) -> Option<f64> {
    let mut camera = packed.tables.camera;
    camera.aperture = 0.0;
    (camera.width, camera.height) = (1, 1);
    let place = Vec4::new(x as f32, y as f32, 0.0, 0.0);
    let ray = crate::camera::camera_ray(&camera, 0, 0, place);
    let hit = intersect_scene(&packed.tables, &ray);
    let depth = f64::from(hit.t * ray.direction.dot(camera.forward)) * packed.unit;
    (hit.reference != NONE && hit.t < FAR && depth > 0.0).then_some(depth)
}

/// Theory: an orbit keeps the distance; a full turn is the identity; points at the target's
/// distance follow a pan by the pinhole's projection; the plane of focus stays in the world when
/// the camera moves along its axis; the nearest point of a sphere lies at the distance of its
/// centre minus its radius.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::pilots::prepare;
    use crate::scene::{self, Axis};
    use std::f64::consts::{PI, TAU};

    fn camera() -> Camera {
        let (position, target) = (DVec3::new(1.0, 2.0, 5.0), DVec3::new(0.25, 0.5, -0.5));
        Camera { focus: 4.0, ..Camera::look_at(position, target, FOV) }
    }

    const FOV: f64 = 40.0;
    const PARALLEL: Projection = Projection::Orthographic { size: 3.0, axis: Axis::Vertical };

    fn near(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-4
    }

    /// Position of a world point in the image, in image heights from its centre, right and down.
    fn projected(camera: &Camera, p: DVec3) -> [f64; 2] {
        let [x, y, z] = axes(camera);
        let d = p - camera.position;
        let height = match camera.projection {
            Projection::Orthographic { size, .. } => size,
            _ => 2.0 * d.dot(z) * (0.5 * FOV.to_radians()).tan(),
        };
        [d.dot(x) / height, -d.dot(y) / height]
    }

    #[test]
    fn orbits_keep_the_distance() {
        let at = camera();
        for (across, over) in [(0.3, 0.0), (-2.0, 0.2), (0.0, -0.4), (1.0, 9.0), (1.0, -9.0)] {
            let turned = orbit(&at, across, over);
            assert!((distance(&turned) - distance(&at)).abs() < 1e-4);
            assert_eq!((turned.target, turned.focus), (at.target, at.focus));
        }
        assert!(near(orbit(&at, TAU, 0.0).position, at.position), "a full turn");
        assert!(
            near(orbit(&orbit(&at, 0.7, 0.2), -0.7, -0.2).position, at.position),
            "there and back"
        );
        assert!(!near(orbit(&at, PI, 0.0).position, at.position), "half a turn is another place");
        assert!(orbit(&at, 0.0, 0.2).position.y > at.position.y, "over leads up");
        // to a viewer who looks from +z to -z, the right is +x
        assert!(
            orbit(&Camera { position: DVec3::Z, target: DVec3::ZERO, ..at }, 0.1, 0.0).position.x
                > 0.0
        );
    }

    #[test]
    fn the_pole_is_not_reached() {
        for over in [9.0, -9.0] {
            let high = orbit(&camera(), 0.0, over);
            let sine = axes(&high)[2].cross(DVec3::Y).length();
            assert!((sine - LEAST_ANGLE.sin()).abs() < 1e-4, "{sine}");
        }
    }

    #[test]
    fn what_is_panned_follows_the_hand() {
        let at = camera();
        let film = Film::default();
        let panned = pan(&at, &film, 0.1, -0.25);
        let [x, y] = projected(&panned, at.target);
        assert!((x - 0.1).abs() < 1e-4 && (y + 0.25).abs() < 1e-4, "{x} {y}");
        let wrong = pan(&at, &film, -0.1, -0.25);
        assert!((projected(&wrong, at.target)[0] - 0.1).abs() > 0.1, "the other way does not");
        let at = Camera { projection: PARALLEL, ..at };
        let [x, y] = projected(&pan(&at, &film, 0.1, -0.25), at.target);
        assert!((x - 0.1).abs() < 1e-4 && (y + 0.25).abs() < 1e-4, "{x} {y}");
    }

    #[test]
    fn the_plane_in_focus_stays() {
        let at = camera();
        for factor in [0.8, 1.3] {
            let moved = dolly(&at, factor);
            let plane = |c: &Camera| (c.position + axes(c)[2] * c.focus).dot(axes(&at)[2]);
            assert!((plane(&moved) - plane(&at)).abs() < 1e-4);
            assert!((distance(&moved) - factor * distance(&at)).abs() < 1e-4);
        }
        assert!(dolly(&at, 0.01).focus > 0.0, "and never gets behind the lens");
        // a parallel projection shows the same from every distance, so the image's size changes
        let moved = dolly(&Camera { projection: PARALLEL, ..at }, 0.5);
        let half = Projection::Orthographic { size: 1.5, axis: Axis::Vertical };
        assert_eq!(moved, Camera { projection: half, ..at });
    }

    #[test]
    fn apertures_open_and_close() {
        let open = aperture(&camera(), 1.25);
        assert_eq!(open.aperture, 0.008);
        assert!(aperture(&open, 1.25).aperture > open.aperture);
        assert_eq!(aperture(&open, 0.8).aperture, 0.0);
        let panorama = Camera { projection: Projection::Panorama, ..camera() };
        assert_eq!(aperture(&panorama, 1.25), panorama);
    }

    #[test]
    fn tidy_numbers_are_short_and_stay() {
        let turned = orbit(&camera(), 0.123, 0.04);
        for x in turned.position.to_array() {
            assert!(x.to_string().len() <= 9, "{x}");
        }
        assert_eq!(tidy(&turned), turned);
        let pinhole = Camera { focus: distance(&camera()), ..camera() };
        let turned = orbit(&pinhole, 0.123, 0.04);
        assert_eq!(turned.focus, distance(&turned), "as a file without a focus has it");
        let lens = orbit(&Camera { aperture: 0.1, ..pinhole }, 0.123, 0.04);
        assert!(lens.focus != turned.focus && lens.focus.to_string().len() <= 9);
        let far = Camera { position: DVec3::new(1.234_567_89e9, 0.0, 0.0), ..camera() };
        assert!((tidy(&far).position.x / far.position.x - 1.0).abs() < 1e-5);
    }

    #[test]
    fn depth_of_a_sphere() {
        let text = r#"
            version = 1
            camera = { position = [7.0, 1.0, 1000.0], target = [7.0, 1.0, 990.0], fov = 40.0 }
            materials.white = { type = "diffuse", reflectance = 0.5 }
            lights = [{ type = "point", position = [0.0, 9.0, 0.0], intensity = 1.0 }]
            shapes = [{ type = "sphere", center = [7.0, 1.0, 995.0], radius = 2.0, material = "white" }]
        "#;
        let scene = scene::parse("ball.toml".as_ref(), text.as_bytes()).unwrap().scene;
        let packed = prepare(&scene, 64, 32).unwrap();
        let depth = depth_at(&packed, 0.5, 0.5).unwrap();
        assert!((depth - 3.0).abs() < 1e-5, "{depth}");
        assert_eq!(depth_at(&packed, 0.01, 0.5), None, "there is no other picture");
        // off the axis, depth is along the view direction, not along the ray: a ray at angle a
        // meets the sphere at t = 5 cos a - sqrt(4 - 25 sin^2 a)
        let up = (0.5f64 * (40f64).to_radians()).tan();
        let angle = (0.5 * up).atan();
        let t = 5.0 * angle.cos() - (4.0 - 25.0 * angle.sin().powi(2)).sqrt();
        let depth = depth_at(&packed, 0.5, 0.25).unwrap();
        assert!((depth - t * angle.cos()).abs() < 1e-5 && (depth - t).abs() > 0.01, "{depth}");
    }
}
