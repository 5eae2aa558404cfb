//! Scenes made of one ingredient for each feature that shaders know, for tests of composition and
//! layout.

use bytemuck::Zeroable;
use caustica::low_level::camera::ProjectionKind;
use caustica::low_level::lights::LightKind;
use caustica::low_level::materials::Bsdf;
use caustica::low_level::math::pixel_filter::FilterKind;
use caustica::low_level::plan::Kernel;
use caustica::low_level::plan::features::{Feature, Features};
use caustica::low_level::scene::settings::{Direct, RadiusRule, RenderSettings};
use caustica::low_level::tables::*;
use glam::{Vec2, Vec3};

/// A scene that is never rendered, and settings.
pub struct Mixture {
    pub scene: SceneTables,
    pub settings: RenderSettings,
}

#[allow(dead_code)] // each test file uses its part
impl Mixture {
    pub fn of(features: &[Feature]) -> Self {
        let settings = RenderSettings { direct: Direct::Photons, ..RenderSettings::default() };
        let mut mixture = Self { scene: SceneTables::empty(), settings };
        for feature in features {
            mixture.add(*feature);
        }
        mixture
    }

    pub fn features(&self) -> Features {
        Features::of(&self.scene, &self.settings)
    }

    /// The kernels in a plan of this scene.
    pub fn kernels(&self) -> Vec<Kernel> {
        let photons = self.features().has(Feature::Photons);
        Kernel::ALL
            .into_iter()
            .filter(|k| photons || matches!(k, Kernel::EyeTrace | Kernel::Resolve))
            .collect()
    }

    fn light(&mut self, kind: u32, reference: u32) {
        self.scene.lights.push(Light { kind, reference, ..Light::zeroed() });
        self.scene.distributions.push(1.0);
    }

    fn area(&mut self, shape: Feature, kind: u32) {
        self.add(shape);
        self.light(LightKind::Area as u32, reference(kind, 0));
    }

    fn material(&mut self, bsdf: Bsdf, absorption: f32) {
        self.scene.materials.push(Material {
            kind: bsdf as u32,
            absorption: Vec3::splat(absorption),
            ..Material::EMPTY
        });
    }

    /// A material whose normal the texture 0 bends.
    fn bent(&mut self, normal_map: u32, bump_map: u32) {
        self.add(Feature::Checker);
        self.scene.materials.push(Material { normal_map, bump_map, bent: 1, ..Material::EMPTY });
    }

    fn add(&mut self, feature: Feature) {
        let s = &mut self.scene;
        match feature {
            Feature::Triangle => s.triangles.push(Triangle::zeroed()),
            Feature::Attributes => {
                s.triangles.push(Triangle::zeroed());
                s.attributes.push(Attributes::zeroed());
            }
            Feature::Sphere => s.spheres.push(Sphere::zeroed()),
            Feature::Rectangle => s.rectangles.push(Rectangle::zeroed()),
            Feature::Disc => s.discs.push(Disc::zeroed()),
            Feature::Cuboid => s.cuboids.push(Cuboid::zeroed()),
            Feature::Outlines => s.outlines.push(Outline::zeroed()),
            Feature::Plane => s.planes.push(Plane::zeroed()),
            Feature::Revolution => {
                s.revolutions.push(Revolution::zeroed());
                s.patches.push(Patch::zeroed());
                s.profile_points.extend([Vec2::ZERO; 3]);
            }
            Feature::Instances => {
                s.instances.push(Instance::zeroed());
                s.groups.push(Group::zeroed());
                self.add(Feature::KdTree);
            }
            Feature::PatchSet => {
                self.add(Feature::Revolution);
                self.add(Feature::KdTree);
            }
            Feature::Unbounded => s.unbounded.push(0),
            Feature::KdTree => {
                s.nodes.push(Node::zeroed());
                s.refs.push(0);
            }
            Feature::Few => {
                s.spheres.push(Sphere::zeroed());
                s.nodes.push(Node::leaf(0, 1));
                s.refs.push(reference(KIND_SPHERE, 0));
            }
            Feature::Textures | Feature::Texels => {
                s.textures.push(Texture { kind: TEXTURE_IMAGE, ..Texture::zeroed() });
                s.texels.push(0);
            }
            Feature::Checker => {
                s.textures.push(Texture { kind: TEXTURE_CHECKER, ..Texture::zeroed() })
            }
            Feature::Material(bsdf) => self.material(bsdf, 0.0),
            Feature::Specular => self.material(Bsdf::Mirror, 0.0),
            Feature::Coated => {
                let coated = 1.0 / 1.5;
                let kind = Bsdf::Coat as u32;
                s.materials.push(Material { kind, coated, ..Material::EMPTY });
            }
            Feature::PartMaps => {
                self.bent(0, NONE);
                let part = self.scene.materials.len() as u32 - 1;
                let kind = Bsdf::Mix as u32;
                let mix = Material { kind, first: part, second: part, ..Material::EMPTY };
                self.scene.materials.push(mix);
            }
            Feature::Maps | Feature::NormalMap => self.bent(0, NONE),
            Feature::BumpMap => self.bent(NONE, 0),
            Feature::Nested => {
                self.add(Feature::Material(Bsdf::Glass));
                self.scene.world.nested = 1;
            }
            Feature::Astride => {
                self.add(Feature::Material(Bsdf::Glass));
                self.scene.camera.medium = ASTRIDE;
            }
            Feature::Absorption => self.material(Bsdf::Glass, 1.0),
            Feature::LobeParameters => self.material(Bsdf::Conductor, 0.0),
            Feature::Layered => self.material(Bsdf::Mix, 0.0),
            Feature::Continued => {
                self.material(Bsdf::Metal, 0.0);
                self.light(LightKind::Point as u32, 0);
            }
            Feature::Lobes => self.material(Bsdf::Metal, 0.0),
            Feature::AreaTriangle => self.area(Feature::Triangle, KIND_TRIANGLE),
            Feature::AreaSphere => self.area(Feature::Sphere, KIND_SPHERE),
            Feature::AreaRectangle => self.area(Feature::Rectangle, KIND_RECTANGLE),
            Feature::AreaDisc => self.area(Feature::Disc, KIND_DISC),
            Feature::AreaCuboid => self.area(Feature::Cuboid, KIND_CUBOID),
            Feature::AreaRevolution => self.area(Feature::Revolution, KIND_REVOLUTION),
            Feature::Lights | Feature::Point | Feature::Photons | Feature::First => {
                self.light(LightKind::Point as u32, 0)
            }
            Feature::Spot => self.light(LightKind::Spot as u32, 0),
            Feature::Infinite => self.light(LightKind::Sun as u32, 0),
            Feature::SunDisc => self.light(LightKind::SunDisc as u32, NONE),
            Feature::Far => {
                self.add(Feature::Infinite);
                self.scene.world.far = 1;
            }
            Feature::Environment => self.light(LightKind::Constant as u32, 0),
            Feature::EnvironmentImage => {
                self.add(Feature::Texels);
                self.light(LightKind::Image as u32, 0);
            }
            Feature::TiltedSky => {
                self.add(Feature::EnvironmentImage);
                for light in &mut self.scene.lights {
                    light.patch_count = 1;
                }
            }
            Feature::Lens => s.camera.aperture = 1.0,
            Feature::Projection => s.camera.projection = ProjectionKind::Fisheye as u32,
            Feature::Filter => s.camera.filter_kind = FilterKind::Tent as u32,
            Feature::SignedFilter => s.camera.filter_kind = FilterKind::Mitchell as u32,
            Feature::Sampled => {
                self.add(Feature::Point);
                self.settings.direct = Direct::Sampled;
            }
            Feature::Local => self.settings.radius_rule = RadiusRule::Local,
            Feature::Split => {
                self.settings.indirect_radius = Some(2.0);
                self.light(LightKind::Point as u32, 0);
            }
            Feature::Cells => {
                self.light(LightKind::Point as u32, 0);
                self.scene.cells.push(Cell::zeroed());
            }
            Feature::Guided => {
                self.light(LightKind::Point as u32, 0);
                self.scene.world.guided = 1;
            }
            Feature::DirectLayer => {}
        }
    }
}
