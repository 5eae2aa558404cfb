//! Scenes made of named ingredients, one for each feature that shaders know, for tests of
//! composition and layout.

use bytemuck::Zeroable;
use caustica::features::Features;
use caustica::plan::Kernel;
use caustica::settings::{Direct, RadiusRule, RenderSettings};
use caustica::tables::*;
use glam::{Vec2, Vec3};

/// A scene, never rendered, and settings.
pub struct Mixture {
    pub scene: Scene,
    pub settings: RenderSettings,
}

#[allow(dead_code)] // each test file uses its part
impl Mixture {
    pub fn of(names: &[&str]) -> Self {
        let settings = RenderSettings { direct: Direct::Photons, ..RenderSettings::default() };
        let mut mixture = Self { scene: Scene::empty(), settings };
        for name in names {
            mixture.add(name);
        }
        mixture
    }

    pub fn features(&self) -> Features {
        Features::of(&self.scene, &self.settings)
    }

    /// The kernels that a plan of this scene has.
    pub fn kernels(&self) -> Vec<Kernel> {
        let photons = self.features().has("photons");
        Kernel::ALL
            .into_iter()
            .filter(|k| photons || matches!(k, Kernel::EyeTrace | Kernel::Resolve))
            .collect()
    }

    fn light(&mut self, kind: u32, reference: u32) {
        self.scene.lights.push(Light { kind, reference, ..Light::zeroed() });
        self.scene.distributions.push(1.0);
    }

    fn area(&mut self, shape: &str, kind: u32) {
        self.add(shape);
        self.light(LIGHT_AREA, reference(kind, 0));
    }

    fn material(&mut self, kind: u32, absorption: f32) {
        self.scene.materials.push(Material {
            kind,
            absorption: Vec3::splat(absorption),
            ..Material::zeroed()
        });
    }

    fn add(&mut self, name: &str) {
        let s = &mut self.scene;
        match name {
            "triangle" => s.triangles.push(Triangle::zeroed()),
            "attributes" => {
                s.triangles.push(Triangle::zeroed());
                s.attributes.push(Attributes::zeroed());
            }
            "sphere" => s.spheres.push(Sphere::zeroed()),
            "rectangle" => s.rectangles.push(Rectangle::zeroed()),
            "disc" => s.discs.push(Disc::zeroed()),
            "cuboid" => s.cuboids.push(Cuboid::zeroed()),
            "facets" => s.facets.push(Facet::zeroed()),
            "plane" => s.planes.push(Plane::zeroed()),
            "revolution" => {
                s.revolutions.push(Revolution::zeroed());
                s.patches.push(Patch::zeroed());
                s.profile_points.extend([Vec2::ZERO; 3]);
            }
            "patch_set" => {
                self.add("revolution");
                self.add("kdtree");
            }
            "unbounded" => s.unbounded.push(0),
            "kdtree" => {
                s.nodes.push(Node::zeroed());
                s.refs.push(0);
            }
            "few" => {
                s.spheres.push(Sphere::zeroed());
                s.nodes.push(Node::leaf(0, 1));
                s.refs.push(reference(KIND_SPHERE, 0));
            }
            "textures" | "texels" => {
                s.textures.push(Texture { kind: TEXTURE_IMAGE, ..Texture::zeroed() });
                s.texels.push(0);
            }
            "checker" => s.textures.push(Texture { kind: TEXTURE_CHECKER, ..Texture::zeroed() }),
            "mirror" | "specular" => self.material(MATERIAL_MIRROR, 0.0),
            "glass" => self.material(MATERIAL_GLASS, 0.0),
            "nested" => {
                self.add("glass");
                self.scene.world.nested = 1;
            }
            "astride" => {
                self.add("glass");
                self.scene.camera.medium = ASTRIDE;
            }
            "absorption" => self.material(MATERIAL_GLASS, 1.0),
            "metal" => self.material(MATERIAL_METAL, 0.0),
            "area_triangle" => self.area("triangle", KIND_TRIANGLE),
            "area_sphere" => self.area("sphere", KIND_SPHERE),
            "area_rectangle" => self.area("rectangle", KIND_RECTANGLE),
            "area_disc" => self.area("disc", KIND_DISC),
            "area_cuboid" => self.area("cuboid", KIND_CUBOID),
            "area_revolution" => self.area("revolution", KIND_REVOLUTION),
            "lights" | "point" => self.light(LIGHT_POINT, 0),
            "spot" => self.light(LIGHT_SPOT, 0),
            "infinite" => self.light(LIGHT_SUN, 0),
            "far" => {
                self.add("infinite");
                self.scene.world.far = 1;
            }
            "environment" => self.light(LIGHT_CONSTANT, 0),
            "environment_image" => {
                self.add("texels");
                self.light(LIGHT_IMAGE, 0);
            }
            "lens" => s.camera.aperture = 1.0,
            "sampled" => {
                self.add("point");
                self.settings.direct = Direct::Sampled;
            }
            "local" => self.settings.radius_rule = RadiusRule::Local,
            "split" => {
                self.settings.indirect_radius = Some(2.0);
                self.light(LIGHT_POINT, 0);
            }
            "cells" => {
                self.light(LIGHT_POINT, 0);
                self.scene.cells.push(Cell::zeroed());
            }
            "guided" => {
                self.light(LIGHT_POINT, 0);
                self.scene.world.guided = 1;
            }
            _ => panic!("no ingredient brings the feature `{name}`"),
        }
    }
}
