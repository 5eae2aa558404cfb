//! Layout of the packed scene for kernels: the struct `Scene` with the short tables in one storage
//! buffer, each table an array of fixed length at a multiple of 16 bytes; and the bindings of every
//! kernel.

use crate::plan::features::{Features, few};
use crate::plan::{Access, Buffer, Kernel, Use};
use crate::tables::{self, Material};
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};

/// Member of the struct `Scene`.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Name, the same as in [`tables::SceneTables`].
    pub name: &'static str,
    /// WGSL type.
    pub wgsl_type: String,
    /// Offset in the buffer, bytes.
    pub offset: usize,
}

/// Struct `Scene` of one scene: its members and the buffer's contents.
#[derive(Clone, Debug, Default)]
pub struct SceneLayout {
    /// Members in order.
    pub members: Vec<Member>,
    /// Contents of the buffer.
    pub bytes: Vec<u8>,
    /// References of the shapes that are tested one after another (see [`few`]).
    pub few: Vec<u32>,
    /// Number of lights, a constant in shaders, which makes the choice trivial if there is only
    /// one.
    lights: usize,
}

impl SceneLayout {
    /// Lays out `scene`. Empty tables are omitted.
    pub fn new(scene: &tables::SceneTables) -> Self {
        let mut out =
            Self { few: few(scene).to_vec(), lights: scene.lights.len(), ..Self::default() };
        out.push("world", "World".into(), bytes_of(&scene.world));
        out.push("camera", "Camera".into(), bytes_of(&scene.camera));
        out.table("spheres", "Sphere", &scene.spheres);
        out.table("rectangles", "Rectangle", &scene.rectangles);
        out.table("discs", "Disc", &scene.discs);
        out.table("cuboids", "Cuboid", &scene.cuboids);
        out.table("planes", "Plane", &scene.planes);
        out.table("revolutions", "Revolution", &scene.revolutions);
        out.table("patches", "Patch", &scene.patches);
        out.table("profile_points", "vec2f", &scene.profile_points);
        out.table("instances", "Instance", &scene.instances);
        out.table("groups", "Group", &scene.groups);
        out.table("unbounded", "u32", &scene.unbounded);
        // shaders refer to the materials even if a scene has no surface
        let placeholder = [Material::zeroed()];
        out.table(
            "materials",
            "Material",
            if scene.materials.is_empty() { &placeholder } else { &scene.materials },
        );
        out.table("textures", "Texture", &scene.textures);
        out.table("lights", "Light", &scene.lights);
        out.table("distributions", "f32", &scene.distributions);
        out.table("cells", "Cell", &scene.cells);
        out
    }

    fn table<T: Pod>(&mut self, name: &'static str, item: &str, items: &[T]) {
        if !items.is_empty() {
            self.push(name, format!("array<{item}, {}>", items.len()), cast_slice(items));
        }
    }

    fn push(&mut self, name: &'static str, wgsl_type: String, bytes: &[u8]) {
        self.members.push(Member { name, wgsl_type, offset: self.bytes.len() });
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(16), 0);
    }

    /// WGSL declarations of the struct and of the scene's constants and functions.
    pub fn declaration(&self) -> String {
        let members: String = self
            .members
            .iter()
            .map(|m| format!("    @align(16) {}: {},\n", m.name, m.wgsl_type))
            .collect();
        let lights = format!("const LIGHT_COUNT: u32 = {}u;\n", self.lights);
        format!("struct SceneTables {{\n{members}}}\n{lights}{}", self.intersect_few())
    }

    /// WGSL declaration of the struct with the members `names` only; padding replaces the others.
    pub fn declaration_of(&self, names: &[&str]) -> String {
        let ends = self.members.iter().skip(1).map(|m| m.offset).chain([self.bytes.len()]);
        let members: String = self
            .members
            .iter()
            .zip(ends)
            .map(|(m, end)| match names.contains(&m.name) {
                true => format!("    @align(16) {}: {},\n", m.name, m.wgsl_type),
                false => format!("    {}: array<vec4u, {}>,\n", m.name, (end - m.offset) / 16),
            })
            .collect();
        format!("struct SceneTables {{\n{members}}}\n")
    }

    /// WGSL function that tests the few shapes, in the same order as the Rust twin. Since their
    /// indices are constants, a software driver reads each shape once for all its lanes instead of
    /// once per lane.
    fn intersect_few(&self) -> String {
        if self.few.is_empty() {
            return String::new();
        }
        let test = |reference: &u32| {
            let index = tables::index_of(*reference);
            let (function, shape) = match tables::kind_of(*reference) {
                tables::KIND_TRIANGLE => ("triangle", "triangles"),
                tables::KIND_SPHERE => ("sphere", "scene.spheres"),
                tables::KIND_RECTANGLE => ("rectangle", "scene.rectangles"),
                tables::KIND_DISC => ("disc", "scene.discs"),
                tables::KIND_CUBOID => ("cuboid", "scene.cuboids"),
                _ => ("plane", "scene.planes"),
            };
            let stop = "if any_hit && (*hit).reference != NONE { return; }";
            format!(
                "    intersect_{function}({shape}[{index}], {reference}u, ray, hit);\n    {stop}\n"
            )
        };
        let tests: String = self.few.iter().map(test).collect();
        let triangles =
            self.few.iter().any(|reference| tables::kind_of(*reference) == tables::KIND_TRIANGLE);
        let shear = if triangles { "    ray_shear = shear_of(ray);\n" } else { "" };
        format!(
            "fn intersect_few(ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {{\n\
             {shear}{tests}}}\n"
        )
    }
}

/// Tables with separate buffers, and their contents.
pub fn long_tables(scene: &tables::SceneTables) -> [(Buffer, &[u8]); 6] {
    [
        (Buffer::Nodes, cast_slice(&scene.nodes)),
        (Buffer::Refs, cast_slice(&scene.refs)),
        (Buffer::Triangles, cast_slice(&scene.triangles)),
        (Buffer::Attributes, cast_slice(&scene.attributes)),
        (Buffer::Outlines, cast_slice(&scene.outlines)),
        (Buffer::Texels, cast_slice(&scene.texels)),
    ]
}

/// Binding of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Parameters of the dispatch, a uniform with a dynamic offset.
    Dispatch,
    /// A storage buffer.
    Storage(Use),
}

impl Bound {
    /// Name in the shader.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dispatch => "dispatch",
            Self::Storage(used) => used.buffer.name(),
        }
    }

    fn wgsl_type(self) -> String {
        match self {
            Self::Dispatch => "Dispatch".to_owned(),
            Self::Storage(used) => match used.access {
                Access::Read | Access::Write => used.buffer.info().wgsl_type(),
                Access::ReadVectors => {
                    format!("array<array<vec4u, {}>>", used.buffer.element_bytes() / 16)
                }
                Access::Atomic => "array<atomic<u32>>".to_owned(),
            },
        }
    }

    fn address_space(self) -> &'static str {
        match self {
            Self::Dispatch => "uniform",
            Self::Storage(used) if used.is_read_only() => "storage, read",
            Self::Storage(_) => "storage, read_write",
        }
    }
}

/// Bindings of `kernel` in group 0; the position in the list is the binding number.
pub fn bindings(kernel: Kernel, features: Features) -> Vec<Bound> {
    let buffers = kernel.uses(features).map(Bound::Storage);
    std::iter::once(Bound::Dispatch).chain(buffers).collect()
}

/// WGSL declarations of `bindings`.
pub fn declarations(bindings: &[Bound]) -> String {
    let line = |(i, b): (usize, &Bound)| {
        let (space, name, of) = (b.address_space(), b.name(), b.wgsl_type());
        format!("@group(0) @binding({i}) var<{space}> {name}: {of};\n")
    };
    bindings.iter().enumerate().map(line).collect()
}
