//! Transfers the results of pilots to tables of another precision.

use super::super::pack::PackedScene;
use super::lights::select::CELL_LEAF;
use super::real::{Real, ToDouble, ToReal};
use super::tables::*;
use crate::prepare::learned::Learned;
use glam::DVec3;

/// Returns everything that pilots decided for `packed`.
pub fn learned(packed: &PackedScene) -> Learned {
    let (world, distributions) = (&packed.tables.world, &packed.tables.distributions);
    let base = packed.learned_from as u32;
    let double = |x: &Real| f64::from(*x);
    let guide = |light: &Light| (light.guide != 0).then(|| light.guide - base);
    let cell = |c: &Cell| {
        (f64::from(c.split), c.axis, if c.axis == CELL_LEAF { c.first - base } else { c.first })
    };
    Learned {
        normalization: packed.normalization,
        near_center: world.near_center.to_double().to_array(),
        near_radius: f64::from(world.near_radius),
        disc_radius: f64::from(world.disc_radius),
        disc_levels: world.disc_levels,
        far: world.far,
        guided: world.guided,
        lights: distributions[..packed.tables.lights.len()].iter().map(double).collect(),
        distributions: distributions[packed.learned_from..].iter().map(double).collect(),
        disc_first: world.disc_first.saturating_sub(base),
        guides: packed.tables.lights.iter().map(guide).collect(),
        cells: packed.tables.cells.iter().map(cell).collect(),
    }
}

/// Applies results that were learned in another precision to tables without learned entries.
pub fn apply(packed: &mut PackedScene, learned: &Learned) {
    let base = packed.learned_from as u32;
    let out = &mut packed.tables;
    out.world.near_center = DVec3::from(learned.near_center).to_real();
    out.world.near_radius = learned.near_radius as Real;
    out.world.disc_radius = learned.disc_radius as Real;
    out.world.disc_levels = learned.disc_levels;
    out.world.disc_first = base + learned.disc_first;
    out.world.far = learned.far;
    out.world.guided = learned.guided;
    let mut before = 0.0;
    for (i, end) in learned.lights.iter().enumerate() {
        out.distributions[i] = *end as Real;
        out.lights[i].selection = (end - before) as Real;
        out.lights[i].guide = learned.guides[i].map_or(0, |first| base + first);
        before = *end;
    }
    out.distributions.extend(learned.distributions.iter().map(|x| *x as Real));
    let cell = |&(split, axis, first): &(f64, u32, u32)| Cell {
        split: split as Real,
        axis,
        first: if axis == CELL_LEAF { base + first } else { first },
        pad: 0,
    };
    out.cells = learned.cells.iter().map(cell).collect();
}
