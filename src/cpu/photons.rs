//! Tracing of a batch's photons in tasks of one core each.

use super::super::geometry::intersect::intersect_scene_many;
use super::super::kernels::grid_build::RecordList;
use super::super::kernels::photon_trace::{PhotonPath, photon_trace};
use super::super::kernels::records::*;
use super::super::shapes::kdtree_stream::STREAM;
use super::super::tables::SceneTables;
use crate::engine::Cancel;
use bytemuck::Zeroable;
use rayon::prelude::*;
use std::mem::size_of_val;
use std::ops::Range;

/// Least and greatest number of photons per task; [`PHOTON_TASKS`] tasks in between.
const PHOTON_TASK: (u32, u32) = (1024, 8192);
const PHOTON_TASKS: u32 = 256;
/// Bytes of the kd-tree and its triangles above which it pays to trace photons interleaved: a
/// smaller scene fits in a core's cache.
const LARGE: usize = 1 << 20;

/// Returns true if the scene exceeds a core's cache, so that rays wait for memory.
fn is_large(scene: &SceneTables) -> bool {
    let SceneTables { nodes, refs, triangles, .. } = scene;
    size_of_val(&nodes[..]) + size_of_val(&refs[..]) + size_of_val(&triangles[..]) > LARGE
}

/// Photons of one task.
struct Photons<'a> {
    scene: &'a SceneTables,
    dispatch: &'a Dispatch,
    sampled: bool,
    ids: Range<u32>,
    /// Traces several photons at a time if true, else one after another. Affects only the speed.
    side_by_side: bool,
    list: &'a mut RecordList,
}

/// Number of rays, and numbers of photons by how their paths ended.
type Ends = (u64, [u64; 3]);

impl pulp::WithSimd for Photons<'_> {
    type Output = Ends;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Ends {
        self.list.records.clear();
        if self.side_by_side { self.side_by_side() } else { self.one_by_one() }
    }
}

impl Photons<'_> {
    #[inline(always)]
    fn one_by_one(self) -> Ends {
        let Self { scene, dispatch, sampled, ids, list, .. } = self;
        let mut all = (0, [0; 3]);
        for id in ids {
            let path =
                photon_trace(scene, dispatch, sampled, id, |record| list.records.push(record));
            add_path(&mut all, &path);
        }
        all
    }

    #[inline(always)]
    fn side_by_side(self) -> Ends {
        let Self { scene, dispatch, sampled, ids, list, .. } = self;
        let first = ids.start;
        let number = |record: &PhotonRecord| ((record.key >> dispatch.key_bits) - first) as usize;
        let mut all = (0, [0; 3]);
        // number of records of each photon, shifted by one; records in the order in which they
        // arise
        let mut counts = vec![0; ids.len() + 1];
        let mut records = Vec::new();
        let mut store = |record: PhotonRecord| {
            counts[number(&record) + 1] += 1;
            records.push(record);
        };
        let mut emitted = ids.map(|id| PhotonPath::new(scene, dispatch, id));
        let mut paths: [Option<PhotonPath>; STREAM] = [None; STREAM];
        intersect_scene_many(scene, |lane, hit| {
            if let (Some(path), Some(hit)) = (&mut paths[lane], hit) {
                if path.meet(scene, dispatch, sampled, hit, &mut store) && path.goes_on(dispatch) {
                    return Some(path.ray);
                }
                add_path(&mut all, path);
            }
            for mut path in emitted.by_ref() {
                if path.goes_on(dispatch) {
                    paths[lane] = Some(path);
                    return Some(path.ray);
                }
                add_path(&mut all, &path);
            }
            None
        });
        // sort the records by photon, keeping each photon's order
        let mut place = 0;
        for count in &mut counts {
            place += *count;
            *count = place;
        }
        list.records.resize(records.len(), PhotonRecord::zeroed());
        for record in records {
            let place = &mut counts[number(&record)];
            list.records[*place] = record;
            *place += 1;
        }
        all
    }
}

#[inline(always)]
fn add_path((rays, ends): &mut Ends, path: &PhotonPath) {
    *rays += u64::from(path.rays);
    ends[path.end] += 1;
}

/// Traces the photons of one batch; the lists come in the order of their keys. Returns the number
/// of rays, and the numbers of photons by how their paths ended. Tasks that start after `cancel`
/// was requested do nothing.
pub fn trace_photons(
    arch: pulp::Arch,
    scene: &SceneTables,
    d: &Dispatch,
    sampled: bool,
    cancel: &Cancel,
    records: &mut Vec<RecordList>,
) -> Ends {
    let photons = d.end.div_ceil(PHOTON_TASKS).clamp(PHOTON_TASK.0, PHOTON_TASK.1);
    records.resize_with(d.end.div_ceil(photons) as usize, RecordList::default);
    let traced = records.par_iter_mut().enumerate().map(|(task, list)| {
        let first = task as u32 * photons;
        if cancel.is_asked() {
            list.records.clear();
            return (0, [0; 3]);
        }
        arch.dispatch(Photons {
            scene,
            dispatch: d,
            sampled,
            ids: first..first + photons.min(d.end - first),
            side_by_side: is_large(scene),
            list,
        })
    });
    let sum = |(sum, all): Ends, (rays, ends): Ends| {
        (sum + rays, std::array::from_fn(|k| all[k] + ends[k]))
    };
    traced.reduce(|| (0, [0; 3]), sum)
}

#[cfg(test)]
mod tests {
    use super::super::super::pilots::prepare;
    use super::super::super::plan::Plan;
    use super::*;
    use crate::scene;
    use pulp::WithSimd;

    // Theory: a photon's path depends only on its index, and lists are in key order. So both
    // methods give the same records in the same order, for all shapes and lights.
    #[test]
    fn side_by_side_is_one_by_one() {
        for name in ["still-life", "caustics", "water-drop", "cornell"] {
            let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let loaded = scene::load(path.as_ref()).unwrap_or_else(|errors| panic!("{errors:?}"));
            let scene = &loaded.scene;
            let packed = prepare(scene, scene.film.width, scene.film.height)
                .unwrap_or_else(|e| panic!("{e}"));
            let plan = Plan::probed(&packed, &loaded.settings);
            let dispatch = plan.dispatch(0);
            let trace = |dispatch: &Dispatch, side_by_side| {
                let (scene, list) = (&packed.tables, &mut RecordList::default());
                let ids = 100..3000;
                let ends = Photons { scene, dispatch, sampled: false, ids, side_by_side, list }
                    .with_simd(pulp::Scalar);
                (ends, list.records.iter().map(|record| format!("{record:?}")).collect::<Vec<_>>())
            };
            let one = trace(&dispatch, false);
            assert!(one.1.len() > 1000, "{name}: {}", one.1.len());
            assert!(one == trace(&dispatch, true), "{name}");
            let planted = Dispatch { seed: dispatch.seed ^ 1, ..dispatch };
            assert!(one != trace(&planted, true), "{name}");
        }
    }
}
