//! Conversion of shapes to tables, to the input of the kd-tree, and to emitters.

use super::accel::kdtree::Primitive;
use super::accel::revolution::{Attributes as RevolutionAttributes, Placement, RevolutionTables};
use super::instances::PackedGroups;
use super::math::EPS;
use super::real::{Real, ToDouble, ToReal, Vec3};
use super::shapes::aabb::Aabb;
use super::shapes::cuboid::cuboid_error;
use super::shapes::disc::disc_error;
use super::shapes::outline::with_margins;
use super::shapes::rectangle::rectangle_error;
use super::tables::*;
use super::{Objects, PackError, image};
use crate::prepare::normalize::Normalization;
use crate::scene::{self, Aov, Mesh, ShapeKind, Transform};
use bytemuck::Zeroable;
use glam::{DQuat, DVec2, DVec3};
use std::borrow::Cow;

/// Spheres of a larger radius, in scene units, are tested outside the kd-tree.
const UNBOUNDED_RADIUS: f64 = 64.0;

/// An emitting shape.
pub struct Emitter {
    /// Its reference; for a revolution, with the index of the revolution instead of a patch.
    pub reference: u32,
    /// Radiance, in world units.
    pub radiance: DVec3,
    /// Area, in scene units.
    pub area: f64,
    /// Index of the shape in the scene.
    pub shape: usize,
}

/// Largest absolute coordinate of the points along each axis.
fn largest(points: &[Vec3]) -> Vec3 {
    points.iter().fold(Vec3::ZERO, |a, p| a.max(p.abs()))
}

/// Length whose rounding moves hits with a flat shape of this `extent` off its plane, along each
/// axis; zero along axes that lie in the plane.
fn off_plane(normal: DVec3, extent: DVec3) -> DVec3 {
    normal.abs() * normal.abs().dot(extent)
}

/// Shapes to pack.
pub struct Input<'a> {
    /// The shapes as described.
    pub shapes: &'a [scene::Shape],
    /// Their geometry.
    pub kinds: &'a [Cow<'a, ShapeKind>],
    /// For each shape its material or those of its triangles.
    pub materials: &'a [Vec<u32>],
    /// Groups that instances place; `None` within a group.
    pub groups: Option<&'a PackedGroups>,
}

type Flattened = (Vec<Primitive>, Vec<u32>, Vec<Emitter>);

/// Fills the shape tables. Returns the primitives of the kd-tree, the reference of each, and the
/// emitters, whose indices are those of their lights. `objects` receives
/// shape indices if the film requests them. `groups` are those that instances place.
pub fn pack_shapes(
    scene: &scene::Scene,
    Input { shapes, kinds, materials, groups }: Input,
    n: &Normalization,
    out: &mut SceneTables,
    objects: Option<&mut Objects>,
) -> Result<Flattened, PackError> {
    let mut objects = objects.filter(|_| scene.film.aovs.has(Aov::Object));
    let mut pack = Pack {
        n,
        out,
        primitives: Vec::new(),
        references: Vec::new(),
        emitters: Vec::new(),
        shape: 0,
        period: DVec2::INFINITY,
    };
    let mut revolutions = RevolutionTables::default();
    for (i, shape) in shapes.iter().enumerate() {
        pack.shape = i;
        let material = materials[i].first().copied().unwrap_or_default();
        let uv = if shape.planar_uv { UV_PLANAR } else { UV_NATURAL };
        pack.period = scene
            .materials
            .get(shape.material)
            .map_or(DVec2::INFINITY, |m| image::period(scene, m));
        let emission = shape.is_emitter().then(|| DVec3::from(shape.emission));
        match &*kinds[i] {
            ShapeKind::Sphere { center, radius } => {
                pack.sphere(*center, *radius, material, uv, emission)
            }
            ShapeKind::Rectangle { origin, u, v } => {
                pack.rectangle(*origin, *u, *v, material, uv, emission)
            }
            ShapeKind::Disc { center, normal, radius } => {
                pack.disc(*center, *normal, *radius, material, uv, emission);
            }
            ShapeKind::Plane { point, normal } => pack.plane(*point, *normal, material, uv),
            ShapeKind::Cuboid { min, max } => pack.cuboid(*min, *max, material, uv, emission),
            ShapeKind::Mesh(mesh) => pack.mesh(mesh, &materials[i], uv, emission),
            ShapeKind::Revolution { segments, transform, newton_tolerance } => {
                let light = pack.light(
                    emission,
                    reference(KIND_REVOLUTION, revolutions.revolutions.len()),
                    0.0,
                );
                let uv = if uv == UV_NATURAL && is_loop(segments) { UV_LOOP } else { uv };
                let attributes =
                    RevolutionAttributes { material, light, uv, step_tolerance: *newton_tolerance };
                let placement = placement(transform, n);
                let boxes = revolutions
                    .push(segments, &placement, attributes)
                    .map_err(|cause| PackError::Profile { shape: i, cause })?;
                for b in boxes {
                    pack.primitives.push(Primitive::Box(Aabb { min: b.min, max: b.max }));
                    pack.references.push(reference(KIND_REVOLUTION, b.patch as usize));
                }
            }
            ShapeKind::Instance { group, map } => {
                let packed = groups.and_then(|groups| groups.of(group));
                let (index, packed) = packed.ok_or(PackError::Group { shape: i })?;
                // each body of glass has a separate material
                let material = if group.shapes().len() == 1 { material } else { NONE };
                let planar = group.shapes().iter().any(|shape| shape.planar_uv);
                let uv = if planar { UV_PLANAR } else { uv };
                let (instance, corners) = packed.placed(index, map, n);
                let instance = Instance { material, uv, ..instance };
                let id = reference(KIND_INSTANCE, pack.out.instances.len());
                pack.out.instances.push(instance);
                pack.primitives.push(Primitive::Box(corners));
                pack.references.push(id);
            }
        }
        if let Some(objects) = &mut objects {
            objects.mark(pack.out, revolutions.patches.len(), i as u32);
        }
    }
    let Pack { primitives, references, emitters, .. } = pack;
    // Sort by kind, so that each leaf lists its triangles first.
    let mut items: Vec<_> = references.into_iter().zip(primitives).collect();
    items.sort_unstable_by_key(|item| item.0);
    let (references, primitives) = items.into_iter().unzip();
    out.revolutions = revolutions.revolutions;
    out.patches = revolutions.patches;
    out.profile_points = revolutions.profile_points;
    Ok((primitives, references, emitters))
}

/// Returns whether a profile ends where it begins, off the axis.
fn is_loop(segments: &[Vec<DVec2>]) -> bool {
    let ends = segments.first().and_then(|s| s.first()).zip(segments.last().and_then(|s| s.last()));
    ends.is_some_and(|(first, last)| first == last && first.x != 0.0)
}

fn placement(transform: &Transform, n: &Normalization) -> Placement {
    Placement {
        rotation: DQuat::from_mat3(&transform.rotation),
        scale: transform.scale / n.unit,
        translation: n.point(transform.translation),
    }
}

struct Pack<'a> {
    n: &'a Normalization,
    out: &'a mut SceneTables,
    primitives: Vec<Primitive>,
    references: Vec<u32>,
    emitters: Vec<Emitter>,
    /// Index of the current shape.
    shape: usize,
    /// Period of its material's texture in (u, v).
    period: DVec2,
}

impl Pack<'_> {
    fn light(&mut self, emission: Option<DVec3>, reference: u32, area: f64) -> u32 {
        let Some(radiance) = emission else { return NONE };
        self.emitters.push(Emitter { reference, radiance, area, shape: self.shape });
        self.emitters.len() as u32 - 1
    }

    /// Adds a primitive whose computed hits lie in the box of `points`, grown by the rounding
    /// errors of those hits. `grow` contains the lengths that are rounded.
    fn boxed(&mut self, reference: u32, points: &[Vec3], grow: Vec3) {
        let b = Aabb::of_points(points);
        let grow = (grow * (64.0 * EPS)).max(Vec3::splat(Real::MIN_POSITIVE));
        self.primitives.push(Primitive::Box(Aabb { min: b.min - grow, max: b.max + grow }));
        self.references.push(reference);
    }

    fn sphere(
        &mut self,
        center: DVec3,
        radius: f64,
        material: u32,
        uv: u32,
        emission: Option<DVec3>,
    ) {
        let c = self.n.point(center);
        let r = radius / self.n.unit;
        // the anchor faces the origin, which is the middle of the scene
        let normal = if c.length() > 1e-3 * r { -c.normalize() } else { DVec3::Y };
        let id = reference(KIND_SPHERE, self.out.spheres.len());
        let light = self.light(emission, id, 4.0 * std::f64::consts::PI * r * r);
        self.out.spheres.push(Sphere {
            anchor: (c + normal * r).to_real(),
            curvature: (1.0 / r) as Real,
            normal: normal.to_real(),
            radius: r as Real,
            material,
            light,
            uv,
            pad: 0,
        });
        if r > UNBOUNDED_RADIUS {
            self.out.unbounded.push(id);
        } else {
            let corners = [(c - DVec3::splat(r)).to_real(), (c + DVec3::splat(r)).to_real()];
            self.boxed(id, &corners, Vec3::splat(largest(&corners).max_element()));
        }
    }

    fn rectangle(
        &mut self,
        origin: DVec3,
        u: DVec3,
        v: DVec3,
        material: u32,
        uv: u32,
        emission: Option<DVec3>,
    ) {
        let (o, u, v) = (self.n.point(origin), u / self.n.unit, v / self.n.unit);
        let normal = u.cross(v);
        let area_sq = normal.length_squared();
        let id = reference(KIND_RECTANGLE, self.out.rectangles.len());
        let light = self.light(emission, id, area_sq.sqrt());
        let outline = self.outline(o, u, v);
        self.out.rectangles.push(Rectangle {
            origin: o.to_real(),
            material,
            normal: normal.normalize().to_real(),
            light,
            u: u.to_real(),
            uv,
            v: v.to_real(),
            area: area_sq.sqrt() as Real,
            dual_u: (v.cross(normal) / area_sq).to_real(),
            outline,
            dual_v: (normal.cross(u) / area_sq).to_real(),
            pad: 0,
        });
        let rectangle = &self.out.rectangles[self.out.rectangles.len() - 1];
        let error = rectangle_error(rectangle);
        let outline = &mut self.out.outlines[outline as usize];
        *outline = with_margins(Outline { error, ..*outline });
        let corners = [o, o + u, o + v, o + u + v].map(DVec3::to_real);
        let length =
            |edge: DVec3, dual: Vec3| edge.abs() * dual.to_double().abs().dot(u.abs() + v.abs());
        let edges = length(u, rectangle.dual_u) + length(v, rectangle.dual_v);
        let grow = off_plane(normal.normalize(), u.abs() + v.abs()) + edges;
        self.boxed(id, &corners, grow.to_real() + largest(&corners));
    }

    /// Adds an outline and returns its index; its error is not set yet.
    fn outline(&mut self, origin: DVec3, u: DVec3, v: DVec3) -> u32 {
        let normal = u.cross(v);
        let area_sq = normal.length_squared();
        self.out.outlines.push(Outline {
            origin: origin.to_real(),
            u: u.to_real(),
            v: v.to_real(),
            dual_u: (v.cross(normal) / area_sq).to_real(),
            dual_v: (normal.cross(u) / area_sq).to_real(),
            ..Outline::zeroed()
        });
        self.out.outlines.len() as u32 - 1
    }

    fn disc(
        &mut self,
        center: DVec3,
        normal: DVec3,
        radius: f64,
        material: u32,
        uv: u32,
        emission: Option<DVec3>,
    ) {
        let c = self.n.point(center);
        let r = radius / self.n.unit;
        let n = normal.normalize();
        let id = reference(KIND_DISC, self.out.discs.len());
        let light = self.light(emission, id, std::f64::consts::PI * r * r);
        self.out.discs.push(Disc {
            center: c.to_real(),
            radius: r as Real,
            normal: n.to_real(),
            material,
            light,
            uv,
            outline: self.out.outlines.len() as u32,
            pad: 0,
        });
        let disc = &self.out.discs[self.out.discs.len() - 1];
        let outline = Outline { origin: disc.center, radius: disc.radius, ..Outline::zeroed() };
        self.out.outlines.push(Outline { error: disc_error(disc), ..outline });
        let half = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt) * r;
        let corners = [(c - half).to_real(), (c + half).to_real()];
        self.boxed(id, &corners, (off_plane(n, half) + half).to_real() + largest(&corners));
    }

    fn plane(&mut self, point: DVec3, normal: DVec3, material: u32, uv: u32) {
        let n = normal.normalize();
        let p = self.n.point(point);
        let nearest = n * p.dot(n);
        let (t, b) = super::math::basis(n.to_real());
        let (t, b) = (t.to_double(), b.to_double());
        let d = (nearest - p) * self.n.unit;
        let start = image::reduced(DVec2::new(d.dot(t), d.dot(b)), self.period);
        self.out.unbounded.push(reference(KIND_PLANE, self.out.planes.len()));
        self.out.planes.push(Plane {
            point: nearest.to_real(),
            material,
            normal: n.to_real(),
            uv,
            tangent: (t * self.n.unit).to_real(),
            u0: start.x as Real,
            bitangent: (b * self.n.unit).to_real(),
            v0: start.y as Real,
            outline: NONE,
            pad: [0; 3],
        });
    }

    fn cuboid(&mut self, min: DVec3, max: DVec3, material: u32, uv: u32, emission: Option<DVec3>) {
        let (lower, upper) = (self.n.point(min), self.n.point(max));
        let e = upper - lower;
        let id = reference(KIND_CUBOID, self.out.cuboids.len());
        let light = self.light(emission, id, 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x));
        let [x, y, z] = [DVec3::X * e, DVec3::Y * e, DVec3::Z * e];
        let outline = self.outline(lower, y, z);
        self.outline(lower, z, x);
        self.outline(lower, x, y);
        let (lower, upper) = (lower.to_real(), upper.to_real());
        let cuboid = Cuboid { lower, material, upper, light, uv, outline, pad: [0; 2] };
        self.out.cuboids.push(cuboid);
        let error = cuboid_error(&cuboid);
        self.out.outlines[outline as usize..]
            .iter_mut()
            .for_each(|f| *f = with_margins(Outline { error, ..*f }));
        self.boxed(id, &[lower, upper], largest(&[lower, upper]));
    }

    fn mesh(&mut self, mesh: &Mesh, materials: &[u32], uv: u32, emission: Option<DVec3>) {
        for (k, triangle) in mesh.triangles.iter().enumerate() {
            let material = materials.get(k).or(materials.first()).copied().unwrap_or_default();
            let corners = triangle.position.map(|i| mesh.positions[i as usize]);
            let p = corners.map(|c| self.n.point(c));
            let index = self.out.triangles.len();
            let id = reference(KIND_TRIANGLE, index);
            let light = self.light(emission, id, 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length());
            let planar = corners.map(|c| DVec2::new(c.x, c.z));
            let uvs = triangle.uv.map(|t| t.map(|i| mesh.uvs[i as usize]));
            let uvs = if uv == UV_PLANAR { Some(planar) } else { uvs };
            // shift all corners by the same periods
            let uvs = uvs.map(|uvs| {
                let shift = image::reduced(uvs[0], self.period) - uvs[0];
                uvs.map(|uv| uv + shift)
            });
            let normals = triangle.normal.map(|t| t.map(|i| mesh.normals[i as usize]));
            let attributes = self.attributes(uvs, normals);
            let p = p.map(|q| q.to_real());
            self.out.triangles.push(Triangle {
                p0: p[0],
                material,
                p1: p[1],
                light,
                p2: p[2],
                attributes,
            });
            self.primitives.push(Primitive::Triangle(p));
            self.references.push(id);
        }
    }

    fn attributes(&mut self, uvs: Option<[DVec2; 3]>, normals: Option<[DVec3; 3]>) -> u32 {
        if uvs.is_none() && normals.is_none() {
            return NONE;
        }
        let t = uvs.unwrap_or_default().map(|t| t.to_real());
        let n = normals.unwrap_or_default().map(|n| n.to_real());
        self.out.attributes.push(Attributes {
            n0: n[0],
            u0: t[0].x,
            n1: n[1],
            v0: t[0].y,
            n2: n[2],
            u1: t[1].x,
            v1: t[1].y,
            u2: t[2].x,
            v2: t[2].y,
            outline_smooth: normals.is_some() as u32,
        });
        self.out.attributes.len() as u32 - 1
    }
}
