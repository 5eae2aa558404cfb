//! `caustica info`: what a scene needs and what it does without.

use std::fmt;
use std::path::PathBuf;

use caustica::scene::{Environment, Light, MaterialKind, Scene, ShapeKind, TextureKind};

use super::output::result;
use super::overrides::Overrides;
use super::render::load;
use super::{Done, Failure};

/// Show what a scene needs and what is left out: features, kernels, bytes of every buffer
#[derive(clap::Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
}

/// What a render of a scene is made of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InfoReport {
    /// Features, and whether the scene needs them.
    pub features: Vec<(String, bool)>,
    /// Kernels, and whether they are compiled.
    pub kernels: Vec<(String, bool)>,
    /// Buffers and their bytes.
    pub buffers: Vec<(String, u64)>,
}

/// Prints the report.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let (scene, settings) = load(&arguments.scene, &arguments.overrides)?;
    let film = scene.film;
    result(format_args!(
        "{}: {} x {} pixels, {} passes",
        scene.name, film.width, film.height, settings.passes
    ))?;
    result(InfoReport { features: features(&scene), ..InfoReport::default() })?;
    Ok(Done::Fully)
}

/// Every feature that scenes may have, and whether this one has it.
fn features(scene: &Scene) -> Vec<(String, bool)> {
    let shape = |is: fn(&ShapeKind) -> bool| scene.shapes.iter().any(|shape| is(&shape.kind));
    let material = |is: fn(&MaterialKind) -> bool| scene.materials.iter().any(|material| is(&material.kind));
    let texture = |is: fn(&TextureKind) -> bool| scene.textures.iter().any(|texture| is(&texture.kind));
    let light = |is: fn(&Light) -> bool| scene.lights.iter().any(is);
    let environment = |is: fn(&Environment) -> bool| scene.environment.as_ref().is_some_and(is);
    let features = [
        ("spheres", shape(|kind| matches!(kind, ShapeKind::Sphere { .. }))),
        ("rectangles", shape(|kind| matches!(kind, ShapeKind::Rectangle { .. }))),
        ("discs", shape(|kind| matches!(kind, ShapeKind::Disc { .. }))),
        ("planes", shape(|kind| matches!(kind, ShapeKind::Plane { .. }))),
        ("boxes", shape(|kind| matches!(kind, ShapeKind::Cuboid { .. }))),
        ("meshes", shape(|kind| matches!(kind, ShapeKind::Mesh(_)))),
        ("revolutions", shape(|kind| matches!(kind, ShapeKind::Revolution { .. }))),
        ("diffuse", material(|kind| matches!(kind, MaterialKind::Diffuse { .. }))),
        ("mirror", material(|kind| matches!(kind, MaterialKind::Mirror { .. }))),
        ("glass", material(|kind| matches!(kind, MaterialKind::Glass { .. }))),
        ("metal", material(|kind| matches!(kind, MaterialKind::Metal { .. }))),
        ("area lights", scene.shapes.iter().any(|shape| shape.is_emitter())),
        ("point lights", light(|light| matches!(light, Light::Point { .. }))),
        ("spot lights", light(|light| matches!(light, Light::Spot { .. }))),
        ("suns", light(|light| matches!(light, Light::Sun { .. }))),
        ("constant environment", environment(|light| matches!(light, Environment::Constant { .. }))),
        ("image environment", environment(|light| matches!(light, Environment::Image { .. }))),
        ("image textures", texture(|kind| matches!(kind, TextureKind::Image { .. }))),
        ("checkers", texture(|kind| matches!(kind, TextureKind::Checker { .. }))),
        ("planks", texture(|kind| matches!(kind, TextureKind::Planks { .. }))),
        ("lens", scene.camera.aperture > 0.0),
    ];
    features.map(|(name, needed)| (name.to_owned(), needed)).to_vec()
}

impl fmt::Display for InfoReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines = Vec::new();
        for (title, entries, word, wanted) in [
            ("features", &self.features, "needed", true),
            ("features", &self.features, "left out", false),
            ("kernels", &self.kernels, "compiled", true),
            ("kernels", &self.kernels, "left out", false),
        ] {
            let of_this_kind = entries.iter().filter(|(_, is)| *is == wanted);
            let names: Vec<&str> = of_this_kind.map(|(name, _)| name.as_str()).collect();
            if !names.is_empty() {
                lines.push(format!("{title} {word}: {}", names.join(", ")));
            }
        }
        if !self.buffers.is_empty() {
            let total: u64 = self.buffers.iter().map(|(_, bytes)| bytes).sum();
            lines.push(format!("{:<32} {:>16}", "buffer", "bytes"));
            for (name, bytes) in self.buffers.iter().chain([&("total".to_owned(), total)]) {
                lines.push(format!("{name:<32} {bytes:>16}"));
            }
        }
        f.write_str(&lines.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn report_shows_both_sides_and_the_sum() {
        let report = InfoReport {
            features: vec![("glass".into(), true), ("lens".into(), false)],
            kernels: vec![("gather".into(), true)],
            buffers: vec![("photons".into(), 4096), ("nodes".into(), 8)],
        };
        let text = report.to_string();
        assert!(
            text.contains("features needed: glass\nfeatures left out: lens\nkernels compiled: gather\n"),
            "{text}"
        );
        assert!(text.lines().last().unwrap().ends_with(" 4104"), "{text}");
        assert_eq!(InfoReport::default().to_string(), "");
    }
}
