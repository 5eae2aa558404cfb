//! What a plan's passes have found in addition to radiance, as channels of a picture file in world
//! units.

use super::super::kernels::aov_trace::AovPixel;
use super::super::kernels::bytes::{AOV_BYTES, PARTS_BYTES, aov_bytes, parts_bytes};
use super::super::kernels::records::{Gathered, Statistics};
use super::super::kernels::resolve_parts::PartsPixel;
use super::super::real::{Real, Vec3};
use super::Plan;
use super::features::Feature;
use crate::engine::{LayerState, Space};
use crate::film::Plane;
use crate::film::exr_file::{Channel, Numbers};
use crate::scene::settings::{Method, RadiusRule};
use crate::scene::{Aov, Aovs};

/// Depth where a pixel's samples hit nothing, as Blender writes it.
pub const NO_DEPTH: f64 = 1e10;

/// What engines keep of a window's pixels and visible points.
pub struct LayerInputs<'a> {
    /// By pixel; empty where no [`Aov`] takes it.
    pub aovs: &'a [AovPixel],
    /// By pixel; empty where photons are not parted.
    pub parts: &'a [PartsPixel],
    /// By visible point, of the last pass; empty for path tracing.
    pub gathered: &'a [Gathered],
    /// By visible point; empty but for the local rule.
    pub statistics: &'a [Statistics],
    /// Passes made, at least one.
    pub passes: u32,
}

impl Plan {
    /// The channels of the [`Aov`]s that are asked for.
    pub fn layers(&self, found: &LayerInputs) -> Vec<Channel> {
        let layering = Layering {
            aovs: self.aovs,
            width: self.width,
            pixels: self.pixels,
            eye_samples: self.eye_samples,
            space: self.space(),
            method: self.settings.method,
            rule: self.settings.radius_rule,
            scale_sq: self.scale_sq(found.passes.max(1) - 1),
        };
        let LayerState { counts, objects, .. } = &self.numbers(found);
        let LayerInputs { parts, statistics, .. } = *found;
        let aovs = &self.named(found.aovs);
        layering.channels(&SavedLayers { aovs, parts, counts, objects, statistics })
    }

    /// What is kept for them between two passes.
    pub fn layer_state(&self, found: &LayerInputs) -> LayerState {
        LayerState {
            aovs: aov_bytes(&self.named(found.aovs)),
            parts: parts_bytes(found.parts),
            ..self.numbers(found)
        }
    }

    /// With the scene's numbers of materials in the place of the tables'.
    fn named(&self, aovs: &[AovPixel]) -> Vec<AovPixel> {
        let named = |p: &AovPixel| AovPixel { material: self.objects.material(p.material), ..*p };
        aovs.iter().map(named).collect()
    }

    /// The part of it that is the same for all engines.
    fn numbers(&self, found: &LayerInputs) -> LayerState {
        let mut state = LayerState::default();
        if self.aovs.has(Aov::Photons) {
            state.counts = found.gathered.iter().map(|gathered| gathered.count).collect();
        }
        if self.aovs.has(Aov::Object) {
            let number = |p: &AovPixel| self.objects.of(p.reference).map_or(0, |shape| shape + 1);
            state.objects = found.aovs.iter().map(number).collect();
        }
        state
    }

    /// Whether `state` is not what goes on to the layers that are asked for.
    pub fn lacks_layers(&self, state: &LayerState) -> bool {
        let pixels = self.pixels as usize;
        self.aovs.are_traced() && state.aovs.len() != pixels * AOV_BYTES
            || self.parts_photons() && state.parts.len() != pixels * PARTS_BYTES
            || self.aovs.has(Aov::Photons)
                && self.features.has(Feature::Photons)
                && state.counts.is_empty()
    }

    /// What tells the render's numbers in those of the world.
    pub fn space(&self) -> Space {
        Space {
            center: self.center.to_array(),
            unit: self.unit,
            radiance_unit: self.radiance_unit,
            glint: self.glint,
            photons: self.features.has(Feature::Photons),
        }
    }
}

/// What is kept of a window's pixels and visible points, whoever keeps it.
pub struct SavedLayers<'a> {
    /// By pixel; empty where no [`Aov`] takes it.
    pub aovs: &'a [AovPixel],
    /// By pixel; empty where photons are not parted.
    pub parts: &'a [PartsPixel],
    /// By visible point; empty where they are not asked for.
    pub counts: &'a [u32],
    /// By pixel; empty where they are not asked for.
    pub objects: &'a [u32],
    /// By visible point; empty but for the local rule.
    pub statistics: &'a [Statistics],
}

/// Makes channels of it.
#[derive(Clone, Copy, Debug)]
pub struct Layering {
    /// Those that are asked for.
    pub aovs: Aovs,
    /// Pixels per row of the window.
    pub width: u32,
    /// Pixels of the window.
    pub pixels: u32,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// What its numbers are in the world.
    pub space: Space,
    /// Who finds the light.
    pub method: Method,
    /// How radii change.
    pub rule: RadiusRule,
    /// Squared radius of the last pass over the squared start radius; of no use under the local
    /// rule.
    pub scale_sq: f64,
}

impl Layering {
    /// The channels of the [`Aov`]s that are asked for.
    pub fn channels(&self, kept: &SavedLayers) -> Vec<Channel> {
        self.aovs.iter().flat_map(|aov| self.channels_of(aov, kept)).collect()
    }

    fn channels_of(&self, aov: Aov, kept: &SavedLayers) -> Vec<Channel> {
        let vector = |names: [&'static str; 3], of: &dyn Fn(&AovPixel) -> [f64; 3]| {
            let plane = |c: usize| self.plane(kept.aovs.iter().map(|p| of(p)[c]));
            (0..3).map(|c| Channel::float(names[c], plane(c))).collect()
        };
        let float =
            |name, values: Vec<f64>| vec![Channel::float(name, self.plane(values.into_iter()))];
        let whole = |name, values: &mut dyn Iterator<Item = u32>| {
            vec![Channel {
                name,
                plane: self.plane(values.map(f64::from)),
                numbers: Numbers::Whole,
            }]
        };
        let hit = |p: &AovPixel| p.hits > 0.0;
        match aov {
            Aov::Albedo => vector(["albedo.R", "albedo.G", "albedo.B"], &|p| wide(p.albedo)),
            Aov::Normal => vector(["normal.X", "normal.Y", "normal.Z"], &|p| wide(p.normal)),
            Aov::Position => vector(["position.X", "position.Y", "position.Z"], &|p| {
                let Space { center, unit, .. } = self.space;
                let position = wide(p.position);
                [0, 1, 2].map(|c| if hit(p) { position[c] * unit + center[c] } else { 0.0 })
            }),
            Aov::Emission => vector(["emission.R", "emission.G", "emission.B"], &|p| {
                wide(p.emission).map(|x| x * self.space.radiance_unit)
            }),
            Aov::Direct if self.method == Method::Path => Vec::new(),
            Aov::Direct => vector(["direct.R", "direct.G", "direct.B"], &|p| {
                wide(p.direct).map(|x| x * self.space.radiance_unit)
            }),
            Aov::Caustic => self.part(["caustic.R", "caustic.G", "caustic.B"], kept, |p| p.caustic),
            Aov::Indirect => {
                self.part(["indirect.R", "indirect.G", "indirect.B"], kept, |p| p.indirect)
            }
            Aov::Depth => {
                let depth =
                    |p: &AovPixel| if hit(p) { one(p.depth) * self.space.unit } else { NO_DEPTH };
                float("depth.Z", kept.aovs.iter().map(depth).collect())
            }
            Aov::Object => whole("object.ID", &mut kept.objects.iter().copied()),
            Aov::Material => {
                whole("material.ID", &mut kept.aovs.iter().map(|p| p.material.wrapping_add(1)))
            }
            Aov::Radius => float("radius.Y", self.radii(kept)),
            Aov::Photons => float("photons.Y", self.photons(kept)),
            // a part of what the picture says of its error, which files hold anyway
            Aov::Variance => Vec::new(),
        }
    }

    /// What photons bring in one way; nothing where path tracing brings it, 0 where there are no
    /// photons.
    fn part(
        &self,
        names: [&'static str; 3],
        kept: &SavedLayers,
        of: fn(&PartsPixel) -> Vec3,
    ) -> Vec<Channel> {
        if self.method == Method::Path {
            return Vec::new();
        }
        let plane = |c: usize| {
            let mut values: Vec<f64> =
                kept.parts.iter().map(|p| wide(of(p))[c] * self.space.radiance_unit).collect();
            values.resize(self.pixels as usize, 0.0);
            self.plane(values.into_iter())
        };
        (0..3).map(|c| Channel::float(names[c], plane(c))).collect()
    }

    fn plane(&self, values: impl Iterator<Item = f64>) -> Plane {
        Plane { width: self.width as usize, values: values.collect() }
    }

    /// Each pixel's gather radius in the last pass; under the local rule, where it is after that
    /// pass.
    fn radii(&self, kept: &SavedLayers) -> Vec<f64> {
        let scale = self.scale_sq.sqrt();
        let Space { unit, photons, .. } = self.space;
        let mut own = kept.statistics.chunks(self.eye_samples.max(1) as usize).map(|points| {
            let scale_sq = |s: &Statistics| {
                if s.scale_sq == 0.0 { 1.0 } else { one(s.scale_sq) - one(s.drop) }
            };
            points.iter().map(|s| scale_sq(s).sqrt()).sum::<f64>() / points.len() as f64
        });
        let radius = |p: &AovPixel| {
            let scale = own.next().filter(|_| self.rule == RadiusRule::Local).unwrap_or(scale);
            if photons { one(p.radius) * unit * scale } else { 0.0 }
        };
        kept.aovs.iter().map(radius).collect()
    }

    /// How many photons each pixel's visible points found in the last pass.
    fn photons(&self, kept: &SavedLayers) -> Vec<f64> {
        let points = kept.counts.chunks(self.eye_samples.max(1) as usize);
        let mut counts: Vec<f64> =
            points.map(|counts| counts.iter().copied().map(f64::from).sum()).collect();
        counts.resize(self.pixels as usize, 0.0);
        counts
    }
}

#[allow(clippy::unnecessary_cast)] // no cast where a Real is an f64
fn one(x: Real) -> f64 {
    x as f64
}

fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(one)
}
