//! What a plan's passes have found beside radiance, as channels of a picture file in world units.

use super::kernels::aov_trace::AovPixel;
use super::kernels::records::{Gathered, Statistics};
use super::kernels::resolve_parts::PartsPixel;
use super::plan::Plan;
use super::real::{Real, Vec3};
use crate::film::Plane;
use crate::film::exr_file::{Channel, Numbers};
use crate::scene::Aov;
use crate::settings::{Method, RadiusRule};

/// Depth where a pixel's samples hit nothing, as Blender writes it.
pub const NO_DEPTH: f64 = 1e10;

/// What engines keep of a window's pixels and visible points.
pub struct Found<'a> {
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
    pub fn layers(&self, found: &Found) -> Vec<Channel> {
        self.aovs.iter().flat_map(|aov| self.channels(aov, found)).collect()
    }

    fn channels(&self, aov: Aov, found: &Found) -> Vec<Channel> {
        let vector = |names: [&'static str; 3], of: &dyn Fn(&AovPixel) -> [f64; 3]| {
            let plane = |c: usize| self.plane(found.aovs.iter().map(|p| of(p)[c]));
            (0..3).map(|c| Channel::float(names[c], plane(c))).collect()
        };
        let float = |name, values: Vec<f64>| vec![Channel::float(name, self.plane(values.into_iter()))];
        let whole = |name, of: &dyn Fn(&AovPixel) -> u32| {
            let values = found.aovs.iter().map(|p| f64::from(of(p)));
            vec![Channel { name, plane: self.plane(values), numbers: Numbers::Whole }]
        };
        let hit = |p: &AovPixel| p.hits > 0.0;
        match aov {
            Aov::Albedo => vector(["albedo.R", "albedo.G", "albedo.B"], &|p| wide(p.albedo)),
            Aov::Normal => vector(["normal.X", "normal.Y", "normal.Z"], &|p| wide(p.normal)),
            Aov::Position => vector(["position.X", "position.Y", "position.Z"], &|p| {
                let center = self.center.to_array();
                let position = wide(p.position);
                [0, 1, 2].map(|c| if hit(p) { position[c] * self.unit + center[c] } else { 0.0 })
            }),
            Aov::Emission => vector(["emission.R", "emission.G", "emission.B"], &|p| {
                wide(p.emission).map(|x| x * self.radiance_unit)
            }),
            Aov::Direct if self.settings.method == Method::Path => Vec::new(),
            Aov::Direct => vector(["direct.R", "direct.G", "direct.B"], &|p| {
                wide(p.direct).map(|x| x * self.radiance_unit)
            }),
            Aov::Caustic => self.part(["caustic.R", "caustic.G", "caustic.B"], found, |p| p.caustic),
            Aov::Indirect => self.part(["indirect.R", "indirect.G", "indirect.B"], found, |p| p.indirect),
            Aov::Depth => {
                let depth = |p: &AovPixel| if hit(p) { one(p.depth) * self.unit } else { NO_DEPTH };
                float("depth.Z", found.aovs.iter().map(depth).collect())
            }
            Aov::Object => whole("object.ID", &|p| self.objects.of(p.reference).map_or(0, |shape| shape + 1)),
            Aov::Material => whole("material.ID", &|p| p.material.wrapping_add(1)),
            Aov::Radius => float("radius.Y", self.radii(found)),
            Aov::Photons => float("photons.Y", self.photons(found)),
            // a part of what the picture says of its error, which files hold anyway
            Aov::Variance => Vec::new(),
        }
    }

    /// What photons bring in one way; nothing where path tracing brings it, 0 where there are no photons.
    fn part(&self, names: [&'static str; 3], found: &Found, of: fn(&PartsPixel) -> Vec3) -> Vec<Channel> {
        if self.settings.method == Method::Path {
            return Vec::new();
        }
        let plane = |c: usize| {
            let mut values: Vec<f64> =
                found.parts.iter().map(|p| wide(of(p))[c] * self.radiance_unit).collect();
            values.resize(self.pixels as usize, 0.0);
            self.plane(values.into_iter())
        };
        (0..3).map(|c| Channel::float(names[c], plane(c))).collect()
    }

    fn plane(&self, values: impl Iterator<Item = f64>) -> Plane {
        Plane { width: self.width as usize, values: values.collect() }
    }

    /// Each pixel's gather radius in the last pass; under the local rule, where it is after that pass.
    fn radii(&self, found: &Found) -> Vec<f64> {
        let scale = self.scale_sq(found.passes.max(1) - 1).sqrt();
        let gathers = self.features.has("photons");
        let mut own = found.statistics.chunks(self.eye_samples as usize).map(|points| {
            let scale_sq = |s: &Statistics| if s.scale_sq == 0.0 { 1.0 } else { one(s.scale_sq - s.drop) };
            points.iter().map(|s| scale_sq(s).sqrt()).sum::<f64>() / points.len() as f64
        });
        let radius = |p: &AovPixel| {
            let scale =
                own.next().filter(|_| self.settings.radius_rule == RadiusRule::Local).unwrap_or(scale);
            if gathers { one(p.radius) * self.unit * scale } else { 0.0 }
        };
        found.aovs.iter().map(radius).collect()
    }

    /// How many photons each pixel's visible points found in the last pass.
    fn photons(&self, found: &Found) -> Vec<f64> {
        let points = found.gathered.chunks(self.eye_samples as usize);
        let mut counts: Vec<f64> =
            points.map(|points| points.iter().map(|g| f64::from(g.count)).sum()).collect();
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
