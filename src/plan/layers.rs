//! Layers rendered in addition to radiance, as EXR channels in world units.

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

/// Depth of a pixel whose samples hit nothing, as written by Blender.
pub const NO_DEPTH: f64 = 1e10;

/// Engine data from which layers are computed.
pub struct LayerInputs<'a> {
    /// AOV sums for each pixel; empty if no requested [`Aov`] needs them.
    pub aovs: &'a [AovPixel],
    /// Photon light by class for each pixel; empty if the classes are not separated.
    pub parts: &'a [PartsPixel],
    /// Gathered sums of the last pass for each visible point; empty for path tracing.
    pub gathered: &'a [Gathered],
    /// Radius statistics for each visible point; empty unless the local rule is used.
    pub statistics: &'a [Statistics],
    /// Number of completed passes, at least one.
    pub passes: u32,
}

impl Plan {
    /// Channels of the requested [`Aov`]s.
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

    /// Layer data to save between two passes.
    pub fn layer_state(&self, found: &LayerInputs) -> LayerState {
        LayerState {
            aovs: aov_bytes(&self.named(found.aovs)),
            parts: parts_bytes(found.parts),
            ..self.numbers(found)
        }
    }

    /// Replaces material indices of the packed scene by those of the scene file.
    fn named(&self, aovs: &[AovPixel]) -> Vec<AovPixel> {
        let named = |p: &AovPixel| AovPixel { material: self.objects.material(p.material), ..*p };
        aovs.iter().map(named).collect()
    }

    /// Photon counts and object IDs, whose format is the same for all engines.
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

    /// Returns true if `state` lacks data for the requested layers, so that it cannot be resumed.
    pub fn lacks_layers(&self, state: &LayerState) -> bool {
        let pixels = self.pixels as usize;
        self.aovs.are_traced() && state.aovs.len() != pixels * AOV_BYTES
            || self.parts_photons() && state.parts.len() != pixels * PARTS_BYTES
            || self.aovs.has(Aov::Photons)
                && self.features.has(Feature::Photons)
                && state.counts.is_empty()
    }

    /// Conversion of scene units to world units.
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

/// Layer data in the saved form, which does not depend on the engine.
pub struct SavedLayers<'a> {
    /// AOV sums for each pixel; empty if no requested [`Aov`] needs them.
    pub aovs: &'a [AovPixel],
    /// Photon light by class for each pixel; empty if the classes are not separated.
    pub parts: &'a [PartsPixel],
    /// Photon counts for each visible point; empty if not requested.
    pub counts: &'a [u32],
    /// Object IDs for each pixel; empty if not requested.
    pub objects: &'a [u32],
    /// Radius statistics for each visible point; empty unless the local rule is used.
    pub statistics: &'a [Statistics],
}

/// Conversion of saved layer data to channels.
#[derive(Clone, Copy, Debug)]
pub struct Layering {
    /// Requested layers.
    pub aovs: Aovs,
    /// Pixels per row of the window.
    pub width: u32,
    /// Pixels of the window.
    pub pixels: u32,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// Conversion of scene units to world units.
    pub space: Space,
    /// Light transport method.
    pub method: Method,
    /// Radius rule.
    pub rule: RadiusRule,
    /// Squared radius of the last pass divided by the squared start radius; unused under the local
    /// rule.
    pub scale_sq: f64,
}

impl Layering {
    /// Channels of the requested [`Aov`]s.
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
            // part of the error estimate, which files always contain
            Aov::Variance => Vec::new(),
        }
    }

    /// Channels of the light of one photon class: none for path tracing, zero without photons.
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

    /// Gather radius of each pixel in the last pass, in world units; under the local rule, the
    /// radius after that pass.
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

    /// Number of photons gathered by each pixel's visible points in the last pass.
    fn photons(&self, kept: &SavedLayers) -> Vec<f64> {
        let points = kept.counts.chunks(self.eye_samples.max(1) as usize);
        let mut counts: Vec<f64> =
            points.map(|counts| counts.iter().copied().map(f64::from).sum()).collect();
        counts.resize(self.pixels as usize, 0.0);
        counts
    }
}

#[allow(clippy::unnecessary_cast)] // not a cast in the f64 compilation
fn one(x: Real) -> f64 {
    x as f64
}

fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(one)
}
