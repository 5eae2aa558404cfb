//! Layers of checkpoints: conversion to EXR channels and merging of two pass ranges, in f64.
//!
//! Merged means are weighted by their number of passes, of samples that hit a surface, or of
//! samples that end at a visible point. Object and material IDs come from the first pass, photon
//! counts and radii from the last.

use super::{Checkpoint, Origin};
use crate::double::kernels::aov_trace::AovPixel;
use crate::double::kernels::bytes::{aov_bytes, aovs_of, parts_bytes, parts_of, statistics_of};
use crate::double::kernels::records::Statistics;
use crate::double::kernels::resolve_parts::PartsPixel;
use crate::double::plan::layers::{Layering, SavedLayers};
use crate::double::real::Vec3;
use crate::engine::{LayerState, State};
use crate::film::exr_file::Channel;
use crate::kernels;
use crate::plan::global_scale_sq;
use crate::scene::settings::{Method, RadiusRule};

impl Checkpoint {
    /// Layers requested by the film in addition to radiance; bit-identical to those of the render.
    pub fn layers(&self) -> Vec<Channel> {
        let Origin { settings, aovs, space, .. } = &self.origin;
        let [width, height] = self.origin.window_size();
        let layering = Layering {
            aovs: *aovs,
            width,
            pixels: width * height,
            eye_samples: if settings.method == Method::Ppm { settings.eye_samples } else { 1 },
            space: *space,
            method: settings.method,
            rule: settings.radius_rule,
            scale_sq: match settings.radius_rule {
                RadiusRule::Fixed => 1.0,
                _ => global_scale_sq(u64::from(self.end()), settings.alpha),
            },
        };
        let LayerState { counts, objects, .. } = &self.state.layers;
        layering.channels(&SavedLayers {
            aovs: &wide_aovs(&self.state),
            parts: &wide_parts(&self.state),
            counts,
            objects,
            statistics: &wide_statistics(&self.state),
        })
    }
}

/// Merges the layers of two consecutive pass ranges.
pub(super) fn joined(first: &State, next: &State) -> LayerState {
    let passes = [first, next].map(|state| f64::from(state.passes));
    let aovs = wide_aovs(first).into_iter().zip(wide_aovs(next));
    let parts = wide_parts(first).into_iter().zip(wide_parts(next));
    LayerState {
        aovs: aov_bytes(&aovs.map(|(a, b)| joined_aovs(passes, &a, &b)).collect::<Vec<_>>()),
        parts: parts_bytes(&parts.map(|(a, b)| joined_parts(&a, &b)).collect::<Vec<_>>()),
        counts: next.layers.counts.clone(),
        objects: first.layers.objects.clone(),
    }
}

/// Weighted mean of `a` and `b`; zero if both weights are zero.
fn mixed([m, n]: [f64; 2], a: Vec3, b: Vec3) -> Vec3 {
    if m + n == 0.0 { Vec3::ZERO } else { (a * m + b * n) / (m + n) }
}

fn joined_aovs(passes: [f64; 2], a: &AovPixel, b: &AovPixel) -> AovPixel {
    let one = |weights: [f64; 2], a: f64, b: f64| mixed(weights, Vec3::splat(a), Vec3::splat(b)).x;
    let (hits, points) = ([a.hits, b.hits], [a.points, b.points]);
    AovPixel {
        albedo: mixed(passes, a.albedo, b.albedo),
        depth: one(hits, a.depth, b.depth),
        normal: mixed(passes, a.normal, b.normal),
        hits: a.hits + b.hits,
        position: mixed(hits, a.position, b.position),
        points: a.points + b.points,
        emission: mixed(passes, a.emission, b.emission),
        radius: one(points, a.radius, b.radius),
        direct: mixed(passes, a.direct, b.direct),
        ..*a
    }
}

fn joined_parts(a: &PartsPixel, b: &PartsPixel) -> PartsPixel {
    let passes = [a.passes, b.passes];
    PartsPixel {
        caustic: mixed(passes, a.caustic, b.caustic),
        passes: a.passes + b.passes,
        indirect: mixed(passes, a.indirect, b.indirect),
        pad: 0,
    }
}

fn wide_aovs(state: &State) -> Vec<AovPixel> {
    if state.bits == 64 {
        return aovs_of(&state.layers.aovs);
    }
    let wide = |p: &kernels::aov_trace::AovPixel| AovPixel {
        albedo: p.albedo.as_dvec3(),
        depth: p.depth.into(),
        normal: p.normal.as_dvec3(),
        hits: p.hits.into(),
        position: p.position.as_dvec3(),
        points: p.points.into(),
        emission: p.emission.as_dvec3(),
        radius: p.radius.into(),
        direct: p.direct.as_dvec3(),
        reference: p.reference,
        material: p.material,
        state: p.state,
        pad: [0; 2],
    };
    kernels::bytes::aovs_of(&state.layers.aovs).iter().map(wide).collect()
}

fn wide_parts(state: &State) -> Vec<PartsPixel> {
    if state.bits == 64 {
        return parts_of(&state.layers.parts);
    }
    let wide = |p: &kernels::resolve_parts::PartsPixel| PartsPixel {
        caustic: p.caustic.as_dvec3(),
        passes: p.passes.into(),
        indirect: p.indirect.as_dvec3(),
        pad: 0,
    };
    kernels::bytes::parts_of(&state.layers.parts).iter().map(wide).collect()
}

fn wide_statistics(state: &State) -> Vec<Statistics> {
    if state.bits == 64 {
        return statistics_of(&state.statistics);
    }
    let wide = |s: &kernels::records::Statistics| Statistics {
        scale_sq: s.scale_sq.into(),
        drop: s.drop.into(),
        count_low: s.count_low,
        count_high: s.count_high,
    };
    kernels::bytes::statistics_of(&state.statistics).iter().map(wide).collect()
}
