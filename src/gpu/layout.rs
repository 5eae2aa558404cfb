//! The flattened scene as a kernel sees it: the struct `Scene` of the short tables in one storage
//! buffer, each table an array of fixed length at a multiple of 16 bytes, and the bindings of every
//! kernel.

use crate::features::{Feature, Features, few};
use crate::plan::Kernel;
use crate::tables::{self, Material};
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};

/// A member of the struct `Scene`.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Name, the same as in [`tables::Scene`].
    pub name: &'static str,
    /// WGSL type.
    pub wgsl_type: String,
    /// Bytes from the buffer's start.
    pub offset: usize,
}

/// The struct `Scene` of one scene: its members and the buffer's content.
#[derive(Clone, Debug, Default)]
pub struct SceneTables {
    /// Members in order.
    pub members: Vec<Member>,
    /// Content of the buffer.
    pub bytes: Vec<u8>,
    /// The shapes that are tested one after another (see [`few`]).
    pub few: Vec<u32>,
    /// How many lights there are, so that a shader knows which it takes where there is one.
    lights: usize,
}

impl SceneTables {
    /// Lays out `scene`. Empty tables are left out.
    pub fn new(scene: &tables::Scene) -> Self {
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
        out.table("unbounded", "u32", &scene.unbounded);
        // shaders name the materials even where a scene has no surface
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

    /// The WGSL declarations of the struct, and of what else is particular to the scene.
    pub fn declaration(&self) -> String {
        let members: String = self
            .members
            .iter()
            .map(|m| format!("    @align(16) {}: {},\n", m.name, m.wgsl_type))
            .collect();
        let lights = format!("const LIGHT_COUNT: u32 = {}u;\n", self.lights);
        format!("struct Scene {{\n{members}}}\n{lights}{}", self.intersect_few())
    }

    /// The function that tests the few shapes, in the order in which the twin does. Since the
    /// compiler knows which they are, a software driver reads one for all its lanes at once, where
    /// each would read for itself.
    fn intersect_few(&self) -> String {
        if self.few.is_empty() {
            return String::new();
        }
        let test = |reference: &u32| {
            let index = reference & ((1 << tables::REFERENCE_BITS) - 1);
            let (function, shape) = match reference >> tables::REFERENCE_BITS {
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
        let triangles = self
            .few
            .iter()
            .any(|reference| reference >> tables::REFERENCE_BITS == tables::KIND_TRIANGLE);
        let shear = if triangles { "    ray_shear = shear_of(ray);\n" } else { "" };
        format!(
            "fn intersect_few(ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {{\n{shear}{tests}}}\n"
        )
    }
}

/// The long tables, each in a buffer of its own: name, the feature that needs it, content.
pub fn long_tables(scene: &tables::Scene) -> [(&'static str, Feature, &[u8]); 6] {
    [
        ("nodes", Feature::KdTree, cast_slice(&scene.nodes)),
        ("refs", Feature::KdTree, cast_slice(&scene.refs)),
        ("triangles", Feature::Triangle, cast_slice(&scene.triangles)),
        ("attributes", Feature::Attributes, cast_slice(&scene.attributes)),
        ("facets", Feature::Facets, cast_slice(&scene.facets)),
        ("texels", Feature::Texels, cast_slice(&scene.texels)),
    ]
}

/// How a kernel uses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Uniform with a dynamic offset.
    Uniform,
    /// Storage, read only.
    Read,
    /// Storage.
    Write,
}

/// A buffer that a kernel binds; the number of the binding is its place in the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Name in the shader and in the plan.
    pub name: &'static str,
    /// Use.
    pub access: Access,
    /// WGSL type.
    pub wgsl_type: &'static str,
}

/// What `kernel` binds, in group 0.
pub fn bindings(kernel: Kernel, features: &Features) -> Vec<Binding> {
    let mut list =
        vec![Binding { name: "dispatch", access: Access::Uniform, wgsl_type: "Dispatch" }];
    if kernel.reads_scene() {
        let mut read =
            |name, wgsl_type| list.push(Binding { name, access: Access::Read, wgsl_type });
        read("scene", "Scene");
        for (name, feature, wgsl_type) in [
            ("nodes", Feature::KdTree, "array<vec2u>"),
            ("refs", Feature::KdTree, "array<u32>"),
            ("triangles", Feature::Triangle, "array<Triangle>"),
            ("attributes", Feature::Attributes, "array<Attributes>"),
            ("texels", Feature::Texels, "array<u32>"),
        ] {
            if features.has(feature) {
                read(name, wgsl_type);
            }
        }
    }
    if kernel == Kernel::Gather && features.has(Feature::Facets) {
        list.push(Binding { name: "facets", access: Access::Read, wgsl_type: "array<Facet>" });
    }
    for (name, writes) in kernel.buffers(features) {
        let access = if writes { Access::Write } else { Access::Read };
        list.push(Binding { name, access, wgsl_type: buffer_type(kernel, name) });
    }
    list
}

fn buffer_type(kernel: Kernel, name: &str) -> &'static str {
    match name {
        "visible_points" => "array<VisiblePoint>",
        "sorted" if kernel == Kernel::Gather => "array<array<vec4u, 2>>",
        "records" | "sorted" => "array<PhotonRecord>",
        "gathered" => "array<Gathered>",
        "film" => "array<FilmPixel>",
        "aovs" => "array<AovPixel>",
        "parts" => "array<PartsPixel>",
        "statistics" => "array<Statistics>",
        "counters" => "Counters",
        "counts" if matches!(kernel, Kernel::GridCount | Kernel::GridScatter) => {
            "array<atomic<u32>>"
        }
        _ => "array<u32>",
    }
}

/// The WGSL declarations of `bindings`.
pub fn declarations(bindings: &[Binding]) -> String {
    let space = |access| match access {
        Access::Uniform => "uniform",
        Access::Read => "storage, read",
        Access::Write => "storage, read_write",
    };
    let line = |(i, b): (usize, &Binding)| {
        format!("@group(0) @binding({i}) var<{}> {}: {};\n", space(b.access), b.name, b.wgsl_type)
    };
    bindings.iter().enumerate().map(line).collect()
}
