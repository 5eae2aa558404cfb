//! Tessellation of a Bezier profile revolved about the y axis into a triangle mesh with smooth
//! normals and (u, v), written as Wavefront OBJ text. Computes in f64.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::{DVec2, DVec3};

use super::bezier::{derivative, point, split};
use super::profile::ProfileError;
use crate::scene::Transform;
use crate::shapes::revolution::MAX_DEGREE;

/// Resolution of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Number of sectors around the axis, at least 3.
    pub sectors: u32,
    /// Largest distance between a profile curve and its polyline, as a fraction of the profile's
    /// size.
    pub flatness: f64,
}

impl Default for Fineness {
    fn default() -> Self {
        Self { sectors: 96, flatness: 2e-4 }
    }
}

impl Fineness {
    /// Resolution with `sectors` sectors, equally fine along the profile: the deviation of a circle
    /// from its chords falls with the square of their number.
    pub fn of_sectors(sectors: u32) -> Self {
        let Self { sectors: own, flatness } = Self::default();
        let coarser = f64::from(own) / f64::from(sectors.max(3));
        Self { sectors, flatness: (flatness * coarser * coarser).clamp(1e-6, 0.1) }
    }
}

/// Vertex of a triangle: indices into positions, uvs and normals.
pub type Corner = [u32; 3];

/// Mesh that shares positions wherever they coincide: on the seam, on the axis, between segments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RevolutionMesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Texture coordinates: u around the axis, v along the profile over all segments.
    pub uvs: Vec<DVec2>,
    /// Unit normals of the exact surface; outward if the profile runs upward.
    pub normals: Vec<DVec3>,
    /// Triangles, counter-clockwise seen from the side that the normals point to.
    pub triangles: Vec<[Corner; 3]>,
}

/// Sample of the profile.
struct Sample {
    /// Radius and height.
    point: DVec2,
    /// Radial and vertical part of the unit normal.
    normal: DVec2,
    v: f64,
}

/// Tessellates the surface that `segments` (control points (radius, height)) sweep about the y
/// axis, in the profile's coordinates.
///
/// # Errors
/// The profile does not define a surface; see [`ProfileError`].
pub fn tessellate(
    segments: &[Vec<DVec2>],
    fineness: &Fineness,
) -> Result<RevolutionMesh, ProfileError> {
    for (segment, points) in segments.iter().enumerate() {
        if !(2..=MAX_DEGREE + 1).contains(&points.len()) {
            return Err(ProfileError::Degree { segment, points: points.len() });
        }
    }
    let all = || segments.iter().flatten();
    if !all().all(|p| p.is_finite()) || !fineness.flatness.is_finite() {
        return Err(ProfileError::NotFinite);
    }
    let low = all().fold(DVec2::INFINITY, |a, p| a.min(*p));
    let high = all().fold(DVec2::NEG_INFINITY, |a, p| a.max(*p));
    let size = (high - low).max_element().max(high.x.abs()).max(low.x.abs());
    let mut builder = Builder {
        mesh: RevolutionMesh::default(),
        sectors: fineness.sectors.max(3),
        weld: 1e-9 * size,
        known: HashMap::new(),
    };
    let tolerance = fineness.flatness.max(1e-7) * size;
    for (index, segment) in segments.iter().enumerate() {
        let mut last: Option<(DVec2, Vec<Corner>)> = None;
        for t in parameters(segment, tolerance) {
            let sample = sample(segment, t, (index as f64 + t) / segments.len() as f64);
            if last.as_ref().is_some_and(|(p, _)| p.distance(sample.point) <= builder.weld) {
                continue;
            }
            let ring = builder.ring(&sample);
            if let Some((_, below)) = &last {
                builder.band(below, &ring);
            }
            last = Some((sample.point, ring));
        }
    }
    if builder.mesh.triangles.is_empty() { Err(ProfileError::Empty) } else { Ok(builder.mesh) }
}

/// Parameters at which to cut a segment: it is halved until each part lies within `tolerance` of
/// its chord and bends little.
fn parameters(segment: &[DVec2], tolerance: f64) -> Vec<f64> {
    fn halve(points: &[DVec2], a: f64, b: f64, tolerance: f64, out: &mut Vec<f64>) {
        let chord = points[points.len() - 1] - points[0];
        let length = chord.length();
        let flat = points.windows(2).all(|w| {
            let leg = w[1] - w[0];
            leg.length() <= 1e-9 * length || chord.angle_to(leg).abs() < 0.15
        });
        let off = points.iter().map(|p| chord.perp_dot(*p - points[0]).abs() / length.max(1e-300));
        let near = length > 0.0 && flat && off.fold(0.0, f64::max) < tolerance;
        let extent = points.iter().fold(0.0_f64, |e, p| e.max(p.distance(points[0])));
        if near || extent < 0.01 * tolerance || b - a < 1e-5 {
            out.push(b);
            return;
        }
        let middle = 0.5 * (a + b);
        let (lower, upper) = split(points, 0.5);
        halve(&lower, a, middle, tolerance, out);
        halve(&upper, middle, b, tolerance, out);
    }
    let mut out = vec![0.0];
    halve(segment, 0.0, 1.0, tolerance, &mut out);
    out
}

fn sample(segment: &[DVec2], t: f64, v: f64) -> Sample {
    let velocity = derivative(segment);
    let fastest = velocity.iter().fold(0.0_f64, |a, d| a.max(d.length()));
    // at a cusp, use the tangent next to it
    let exact = point(&velocity, t);
    let tangent = if exact.length() > 1e-6 * fastest {
        exact
    } else {
        point(&velocity, t + (0.5 - t) * 1e-3)
    };
    let p = point(segment, t);
    // a profile on the negative side of the axis sweeps the same circles
    let side = if p.x < 0.0 { -1.0 } else { 1.0 };
    let normal = DVec2::new(tangent.y, -tangent.x * side).normalize_or(DVec2::X);
    Sample { point: DVec2::new(p.x * side, p.y), normal, v }
}

struct Builder {
    mesh: RevolutionMesh,
    sectors: u32,
    /// Distance below which points are merged.
    weld: f64,
    known: HashMap<[i64; 3], u32>,
}

impl Builder {
    /// Adds the vertices around the axis at a sample; the first one is repeated at the end with u =
    /// 0.
    fn ring(&mut self, sample: &Sample) -> Vec<Corner> {
        let n = self.sectors;
        // radii within the merging distance of zero lie on the axis
        let r = if sample.point.x <= self.weld { 0.0 } else { sample.point.x };
        let mut corner = |k: u32| {
            // theta runs from -pi to pi, u = 1/2 - theta / 2 pi from 1 to 0
            let theta =
                std::f64::consts::TAU * f64::from(k % n) / f64::from(n) - std::f64::consts::PI;
            let (sin, cos) = theta.sin_cos();
            let position = DVec3::new(r * cos, sample.point.y, r * sin);
            let key = position.to_array().map(|x| (x / (4.0 * self.weld)).round() as i64);
            let next = self.mesh.positions.len() as u32;
            let index = *self.known.entry(key).or_insert(next);
            if index == next {
                self.mesh.positions.push(position);
            }
            let other = self.mesh.uvs.len() as u32;
            self.mesh.uvs.push(DVec2::new(1.0 - f64::from(k) / f64::from(n), sample.v));
            self.mesh.normals.push(DVec3::new(
                sample.normal.x * cos,
                sample.normal.y,
                sample.normal.x * sin,
            ));
            [index, other, other]
        };
        (0..=n).map(&mut corner).collect()
    }

    /// Adds the triangles between two rings, except those that degenerate on the axis.
    fn band(&mut self, below: &[Corner], above: &[Corner]) {
        for k in 0..below.len() - 1 {
            let quad = [below[k], above[k], above[k + 1], below[k + 1]];
            for t in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                if t[0][0] != t[1][0] && t[1][0] != t[2][0] && t[2][0] != t[0][0] {
                    self.mesh.triangles.push(t);
                }
            }
        }
    }
}

impl RevolutionMesh {
    /// Transforms the mesh to world space.
    #[must_use]
    pub fn transformed(mut self, world_from_object: &Transform) -> Self {
        self.positions.iter_mut().for_each(|p| *p = world_from_object.point(*p));
        self.normals.iter_mut().for_each(|n| *n = world_from_object.direction(*n));
        self
    }

    /// Wavefront OBJ text: `v`, `vt`, `vn` and `f v/vt/vn` lines, with `header` lines as comments.
    pub fn to_obj(&self, header: &str) -> String {
        let mut out = String::new();
        // writing to a String cannot fail
        for line in header.lines() {
            let _ = writeln!(out, "# {line}");
        }
        for p in &self.positions {
            let _ = writeln!(out, "v {} {} {}", p.x, p.y, p.z);
        }
        for uv in &self.uvs {
            let _ = writeln!(out, "vt {} {}", uv.x, uv.y);
        }
        for n in &self.normals {
            let _ = writeln!(out, "vn {:.7} {:.7} {:.7}", n.x, n.y, n.z);
        }
        for t in &self.triangles {
            let [a, b, c] = t.map(|[v, vt, vn]| format!("{}/{}/{}", v + 1, vt + 1, vn + 1));
            let _ = writeln!(out, "f {a} {b} {c}");
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drop_profile() -> Vec<Vec<DVec2>> {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        vec![
            vec![p(0.0, 0.0), p(0.4, 0.0)],
            vec![p(0.4, 0.0), p(0.9, 0.4), p(0.35, 0.7), p(0.0, 1.3)],
        ]
    }

    /// Number of edges without a partner in the other direction.
    fn open_edges(mesh: &RevolutionMesh) -> usize {
        let mut count: HashMap<(u32, u32), i32> = HashMap::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                let (a, b) = (t[k][0], t[(k + 1) % 3][0]);
                *count.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        count.values().filter(|&&c| c != 0).count()
    }

    // Theory: a profile with both ends on the axis gives a closed mesh: every edge occurs once in
    // each direction, and the enclosed volume is positive (outward normals) and tends to pi times
    // the integral of r^2 dy.
    #[test]
    fn a_closed_profile_makes_a_closed_mesh() {
        let profile = drop_profile();
        let mesh = tessellate(&profile, &Fineness::default()).expect("a surface");
        assert_eq!(open_edges(&mesh), 0);
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|c| mesh.positions[c[0] as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let mut exact = 0.0;
        let n = 20_000;
        for i in 0..n {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            let (p, v) = (point(&profile[1], t), point(&derivative(&profile[1]), t));
            exact += std::f64::consts::PI * p.x * p.x * v.y / f64::from(n);
        }
        assert!((volume / exact - 1.0).abs() < 2e-3, "{volume} {exact}");
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|c| mesh.positions[c[0] as usize]);
            let face = (b - a).cross(c - a);
            assert!(t.iter().all(|c| face.normalize().dot(mesh.normals[c[2] as usize]) > 0.5));
        }
        // a mesh with one triangle removed is not closed
        let mut open = mesh.clone();
        open.triangles.pop();
        assert_eq!(open_edges(&open), 3);
    }

    #[test]
    fn obj_text_reads_back() {
        let mesh = tessellate(&drop_profile(), &Fineness { sectors: 12, flatness: 1e-2 })
            .expect("a surface");
        let text = mesh.to_obj("a drop");
        let options =
            tobj::LoadOptions { triangulate: true, single_index: false, ..Default::default() };
        let read = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default()));
        let (models, _) = read.expect("an OBJ file");
        let m = &models[0].mesh;
        assert_eq!(m.indices.len(), 3 * mesh.triangles.len());
        assert_eq!(m.positions.len(), 3 * mesh.positions.len());
        assert_eq!(
            (m.normal_indices.len(), m.texcoord_indices.len()),
            (m.indices.len(), m.indices.len())
        );
        assert!(m.texcoords.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!(text.starts_with("# a drop\nv "));
    }

    #[test]
    fn profiles_that_are_no_surface_are_refused() {
        let p = DVec2::new;
        let of = |points: Vec<DVec2>| tessellate(&[points], &Fineness::default()).err();
        assert_eq!(of(vec![p(0.0, 0.0), p(0.0, 1.0)]), Some(ProfileError::Empty));
        assert_eq!(of(vec![p(1.0, 1.0), p(1.0, 1.0)]), Some(ProfileError::Empty));
        assert_eq!(of(vec![p(1.0, 1.0)]), Some(ProfileError::Degree { segment: 0, points: 1 }));
        assert_eq!(of(vec![p(1.0, f64::NAN), p(1.0, 0.0)]), Some(ProfileError::NotFinite));
    }
}
