//! An indexed triangle mesh with normals and texture coordinates, grouped by material, written as
//! OBJ.

use glam::{DMat3, DVec2, DVec3};
use std::fmt::Write;

/// Triangles with one normal and one texture coordinate per vertex.
#[derive(Default)]
pub struct Mesh {
    /// Vertex positions, in scene units.
    pub positions: Vec<DVec3>,
    /// Unit normals, one per vertex.
    pub normals: Vec<DVec3>,
    /// Texture coordinates, one per vertex; v = 0 is an image's bottom row.
    pub uvs: Vec<DVec2>,
    /// Counter-clockwise triangles seen from outside.
    pub triangles: Vec<[usize; 3]>,
    /// `(material, first triangle)`: each material holds up to the next entry.
    pub groups: Vec<(&'static str, usize)>,
}

impl Mesh {
    /// Triangles added from here on belong to `material`.
    pub fn set_material(&mut self, material: &'static str) {
        self.groups.push((material, self.triangles.len()));
    }

    /// Adds a vertex and returns its index; `normal` need not be unit.
    pub fn vertex(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> usize {
        self.positions.push(position);
        self.normals.push(normal.normalize());
        self.uvs.push(uv);
        self.positions.len() - 1
    }

    /// Adds a flat convex polygon, counter-clockwise seen from outside, as a fan.
    pub fn polygon(&mut self, corners: &[(DVec3, DVec2)]) {
        let [a, b, c] = [corners[0].0, corners[1].0, corners[2].0];
        let normal = (b - a).cross(c - a);
        let at: Vec<usize> = corners.iter().map(|&(p, uv)| self.vertex(p, normal, uv)).collect();
        for k in 1..at.len() - 1 {
            self.triangles.push([at[0], at[k], at[k + 1]]);
        }
    }

    /// Adds a grid of `rows` x `cols` vertices, `vertex(row, col)` giving (position, normal, uv).
    /// Quads wind so that (next column - this) x (next row - this) points outward; quads without
    /// area are left out.
    pub fn grid(
        &mut self,
        rows: usize,
        cols: usize,
        mut vertex: impl FnMut(usize, usize) -> (DVec3, DVec3, DVec2),
    ) {
        let first = self.positions.len();
        for row in 0..rows {
            for col in 0..cols {
                let (position, normal, uv) = vertex(row, col);
                self.vertex(position, normal, uv);
            }
        }
        for row in 1..rows {
            for col in 1..cols {
                let d = first + row * cols + col;
                let (a, b, c) = (d - cols - 1, d - cols, d - 1);
                // the diagonal along which the two halves agree best with the normals
                let splits = [[[a, b, d], [a, d, c]], [[a, b, c], [b, d, c]]];
                let [one, other] =
                    splits.map(|s| s.map(|t| self.agreement(t)).into_iter().fold(1.0, f64::min));
                let split = splits[usize::from(other > one + 1e-6)];
                for triangle in split {
                    if self.face(triangle).length() > 1e-9 {
                        self.triangles.push(triangle);
                    }
                }
            }
        }
    }

    /// Twice the area of a triangle, as a vector along its normal.
    fn face(&self, triangle: [usize; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|k| self.positions[k]);
        (b - a).cross(c - a)
    }

    /// The least cosine between a triangle's normal and those of its corners; 1 if it has no area.
    fn agreement(&self, triangle: [usize; 3]) -> f64 {
        let face = self.face(triangle);
        if face.length() < 1e-9 {
            return 1.0;
        }
        triangle.map(|k| self.normals[k].dot(face) / face.length()).into_iter().fold(1.0, f64::min)
    }

    /// A box with flat sides; `uv` maps a point on the side with the given normal to the texture.
    pub fn cuboid(&mut self, min: DVec3, max: DVec3, uv: impl Fn(DVec3, DVec3) -> DVec2) {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut normal = DVec3::ZERO;
                normal[axis] = sign;
                let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(s, t)| {
                    let mut p = if sign > 0.0 { max } else { min };
                    p[b] = if s == 1 { max[b] } else { min[b] };
                    p[c] = if t == 1 { max[c] } else { min[c] };
                    (p, uv(p, normal))
                });
                if sign < 0.0 {
                    corners.reverse();
                }
                self.polygon(&corners);
            }
        }
    }

    /// Appends `other` turned by `rotate` and moved by `translate`, in the material now set.
    pub fn append(&mut self, other: &Mesh, rotate: DMat3, translate: DVec3) {
        let first = self.positions.len();
        self.positions.extend(other.positions.iter().map(|&p| rotate * p + translate));
        self.normals.extend(other.normals.iter().map(|&n| rotate * n));
        self.uvs.extend(&other.uvs);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + first)));
    }

    /// The mesh as a Wavefront OBJ; `comment` goes on top, `library` names the MTL file of the
    /// groups.
    pub fn to_obj(&self, comment: &str, library: Option<&str>) -> String {
        let mut out = format!("# {comment}\n# {} triangles\n", self.triangles.len());
        if let Some(library) = library {
            writeln!(out, "mtllib {library}").unwrap();
        }
        for p in &self.positions {
            writeln!(out, "v {} {} {}", short(p.x, 4), short(p.y, 4), short(p.z, 4)).unwrap();
        }
        for t in &self.uvs {
            writeln!(out, "vt {} {}", short(t.x, 4), short(t.y, 4)).unwrap();
        }
        for n in &self.normals {
            writeln!(out, "vn {} {} {}", short(n.x, 3), short(n.y, 3), short(n.z, 3)).unwrap();
        }
        let mut groups = self.groups.iter().peekable();
        for (k, triangle) in self.triangles.iter().enumerate() {
            while let Some((material, _)) = groups.next_if(|group| group.1 <= k) {
                writeln!(out, "usemtl {material}").unwrap();
            }
            let [a, b, c] = triangle.map(|k| k + 1);
            writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}").unwrap();
        }
        out
    }
}

/// `x` with at most `digits` decimals and no trailing zeros.
fn short(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
