//! Cuts Bezier profiles into the patches that `shapes::revolution` intersects, and computes their
//! boxes for the kd-tree. Computes in f64 and rounds to the kernels' precision at the end.

use super::real::{Real, ToDouble, ToReal, Vec2, Vec3};
use glam::{DMat3, DVec2, DVec3};

pub use crate::accel::profile::{Placement, ProfileError};

use super::shapes::revolution::{Patch, Revolution};
use super::shapes::revolution_roots::STEP_TOLERANCE;
use crate::accel::profile::{Piece, check, pieces};

/// Padding of bounds, in local units: more than the rounding errors of the intersection.
const BOUNDS_PAD: f64 = 2e-6;
/// Number of sectors of a ring that is thin relative to its radius; other rings get one box.
const SECTORS: u32 = 8;

/// Attributes that the caller attaches to a surface, stored unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Index of the material.
    pub material: u32,
    /// Index of the light, or the caller's value for none.
    pub light: u32,
    /// Source of the texture coordinates, one of the `UV_*` constants.
    pub uv: u32,
    /// Newton steps shorter than this fraction of the profile's size end the root search; 0 selects
    /// the limit of the precision.
    pub step_tolerance: f64,
}

/// Axis-aligned box that encloses an angular sector of a patch, scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchBox {
    /// Index of the patch.
    pub patch: u32,
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

/// Tables of all surfaces of revolution of a scene, as the kernels read them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RevolutionTables {
    /// Frame and attributes of each surface.
    pub revolutions: Vec<Revolution>,
    /// Patches of all surfaces.
    pub patches: Vec<Patch>,
    /// Control points of all patches, in chord coordinates.
    pub profile_points: Vec<Vec2>,
}

impl RevolutionTables {
    /// Adds the surface that `segments` (control points (radius, height), any degree from 1 to 15)
    /// sweep about the y axis, placed in the scene, and returns the boxes of its patches.
    ///
    /// # Errors
    /// The profile does not define a surface; nothing is added then.
    pub fn push(
        &mut self,
        segments: &[Vec<DVec2>],
        placement: &Placement,
        attributes: Attributes,
    ) -> Result<Vec<PatchBox>, ProfileError> {
        check(segments, placement)?;
        let all = segments.iter().flatten();
        let (low, high) =
            all.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
        let middle = 0.5 * (low.y + high.y);
        let size = (0.5 * (high.y - low.y)).max(high.x.abs()).max(low.x.abs());
        if !(size > 0.0 && size.is_finite()) {
            return Err(ProfileError::Empty);
        }
        // the frame in the kernels' precision
        let revolution = frame(placement, middle, size, segments.len(), attributes);
        let to_local = |p: &DVec2| DVec2::new(p.x, p.y - middle) / size;
        let step_tolerance = STEP_TOLERANCE.max(attributes.step_tolerance as Real);
        let mut boxes = Vec::new();
        let before = (self.patches.len(), self.profile_points.len());
        for (index, segment) in segments.iter().enumerate() {
            let local: Vec<DVec2> = segment.iter().map(to_local).collect();
            for piece in pieces(&local) {
                self.push_piece(&piece, index as u32, &revolution, step_tolerance, &mut boxes);
            }
        }
        if boxes.is_empty() {
            self.patches.truncate(before.0);
            self.profile_points.truncate(before.1);
            return Err(ProfileError::Empty);
        }
        self.revolutions.push(revolution);
        Ok(boxes)
    }

    fn push_piece(
        &mut self,
        piece: &Piece,
        segment: u32,
        revolution: &Revolution,
        step_tolerance: Real,
        boxes: &mut Vec<PatchBox>,
    ) {
        let (first, last) = (piece.points[0], piece.points[piece.points.len() - 1]);
        let length = first.distance(last);
        let reach = piece.points.iter().fold(0.0_f64, |a, p| a.max(p.x));
        if !(length > 1e-9 && reach > 1e-9) {
            return;
        }
        // origin and axis rounded as the kernels read them; the control points compensate for the
        // rounding
        let origin = first.to_real();
        let axis = ((last - first) / length).to_real();
        let (o, e) = (origin.to_double(), axis.to_double());
        let chord = |p: DVec2| {
            let q = p - o;
            DVec2::new(e.dot(q), e.y * q.x - e.x * q.y) / e.length_squared()
        };
        let local: Vec<DVec2> = piece.points.iter().map(|&p| chord(p)).collect();
        let end = local[local.len() - 1].x as Real;
        if end <= 0.0 {
            // shorter than the rounding of its origin
            return;
        }
        let low = piece.points.iter().fold(DVec2::INFINITY, |a, p| a.min(*p)) - BOUNDS_PAD;
        let high = piece.points.iter().fold(DVec2::NEG_INFINITY, |a, p| a.max(*p)) + BOUNDS_PAD;
        let (phi_min, phi_max) =
            local.iter().fold((0.0_f64, 0.0_f64), |(a, b), p| (a.min(p.y), b.max(p.y)));
        let patch = Patch {
            revolution: self.revolutions.len() as u32,
            segment,
            first_point: self.profile_points.len() as u32,
            degree: (local.len() - 1) as u32,
            origin,
            axis,
            r_min: low.x.max(0.0) as Real,
            r_max: high.x as Real,
            y_min: low.y as Real,
            y_max: high.y as Real,
            phi_min: (phi_min - 2e-7) as Real,
            phi_max: (phi_max + 2e-7) as Real,
            slope: (piece.slope * 1.001 + 1e-6) as Real,
            length: end,
            t0: piece.t0 as Real,
            t1: piece.t1 as Real,
            wobble: (piece.wobble * 1.001 + 1e-6) as Real,
            step_tolerance,
        };
        let index = self.patches.len() as u32;
        self.patches.push(patch);
        self.profile_points.extend(local.iter().map(|p| p.to_real()));
        let sectors = if f64::from(patch.r_min) > 0.4 * reach { SECTORS } else { 1 };
        boxes
            .extend((0..sectors).map(|k| sector_box(revolution, index, &piece.points, k, sectors)));
    }
}

fn frame(
    placement: &Placement,
    middle: f64,
    size: f64,
    segments: usize,
    attributes: Attributes,
) -> Revolution {
    let axes = DMat3::from_quat(placement.rotation.normalize());
    let scale = placement.scale * size;
    Revolution {
        x_axis: axes.x_axis.to_real(),
        scale: scale as Real,
        y_axis: axes.y_axis.to_real(),
        inv_scale: (1.0 / scale) as Real,
        z_axis: axes.z_axis.to_real(),
        segments: segments as u32,
        center: (placement.translation + axes.y_axis * (placement.scale * middle)).to_real(),
        material: attributes.material,
        light: attributes.light,
        uv: attributes.uv,
        padding: [0; 2],
    }
}

/// Bounding box of sector `k` of `sectors` of the ring swept by the hull of `points` (local r, y).
fn sector_box(
    revolution: &Revolution,
    patch: u32,
    points: &[DVec2],
    k: u32,
    sectors: u32,
) -> PatchBox {
    let [from, to] = [k, k + 1].map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(sectors));
    let scale = f64::from(revolution.scale);
    let center = revolution.center.to_double();
    let axes = [revolution.x_axis, revolution.y_axis, revolution.z_axis].map(Vec3::to_double);
    // largest component along a scene direction over the sector; linear in the hull's points
    let support = |direction: DVec3| {
        let [x, y, z] = axes.map(|a| a.dot(direction));
        let (g_min, g_max) = cosine_range(x, z, from, to);
        let value = |p: &DVec2| p.x * (if p.x >= 0.0 { g_max } else { g_min }) + p.y * y;
        points.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
    };
    let pad = BOUNDS_PAD + 1e-6 * center.abs().max_element() / scale;
    let extent = |sign: f64| {
        DVec3::from_array([DVec3::X, DVec3::Y, DVec3::Z].map(|e| sign * (support(e * sign) + pad)))
    };
    PatchBox {
        patch,
        min: (center + extent(-1.0) * scale).to_real(),
        max: (center + extent(1.0) * scale).to_real(),
    }
}

/// Range of x cos a + z sin a for a in [from, to], an interval within one turn.
fn cosine_range(x: f64, z: f64, from: f64, to: f64) -> (f64, f64) {
    let at = |a: f64| x * a.cos() + z * a.sin();
    let (mut low, mut high) = (at(from).min(at(to)), at(from).max(at(to)));
    let peak = z.atan2(x);
    let holds = |a: f64| (a - from).rem_euclid(std::f64::consts::TAU) <= to - from;
    if holds(peak) {
        high = x.hypot(z);
    }
    if holds(peak + std::f64::consts::PI) {
        low = -x.hypot(z);
    }
    (low, high)
}
