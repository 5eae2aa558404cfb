//! Shader files, and the preprocessor that removes code that a scene does not require.
//!
//! Optional code is fenced by whole lines `//#if CONDITION`, `//#else` and `//#end`; a condition
//! consists of names, `&&` and, with lower precedence, `||`. Removed lines are replaced by empty
//! lines, so that line numbers stay valid.

use crate::materials::SHADERS;
use std::collections::BTreeSet;

/// Shader file, and the condition under which a kernel needs it (empty: always).
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    /// Path below `shaders/`.
    pub path: &'static str,
    /// Text of the file.
    pub text: &'static str,
    /// Condition under which a kernel needs it.
    pub condition: &'static str,
}

macro_rules! fragments {
    ($($path:literal if $condition:literal,)*) => {
        &[$(Fragment {
            path: $path,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
            condition: $condition,
        }),*]
    };
}

/// All shader files.
pub fn fragments() -> Vec<Fragment> {
    let materials =
        SHADERS.iter().map(|&(path, text, condition)| Fragment { path, text, condition });
    SHARED.iter().copied().chain(materials).collect()
}

/// Shader files other than those of materials.
const SHARED: &[Fragment] = fragments![
    "shapes/table.wgsl" if "scene || gather && lobes || gather && outlines",
    "tables.wgsl" if "scene || gather && lobes || gather && outlines",
    "math/vector.wgsl" if "scene || gather || resolve || resolve_parts",
    "math/octahedral.wgsl" if "scene || gather",
    "math/trig.wgsl" if "scene || gather && lobes || gather && outlines",
    "math/rng.wgsl" if "scene",
    "math/sampling.wgsl" if "scene",
    "math/pixel_filter.wgsl" if "eye_trace && filter || aov_trace && filter",
    "shapes/ray.wgsl" if "scene",
    "shapes/sphere.wgsl" if "scene && sphere",
    "shapes/rectangle.wgsl" if "scene && rectangle",
    "shapes/disc.wgsl" if "scene && disc || scene && plane",
    "shapes/cuboid.wgsl" if "scene && cuboid",
    "shapes/outline.wgsl" if "gather && outlines",
    "shapes/triangle.wgsl" if "scene && triangle",
    "shapes/revolution_profile.wgsl" if "scene && revolution",
    "shapes/revolution_roots.wgsl" if "scene && revolution",
    "shapes/revolution.wgsl" if "scene && revolution",
    "shapes/instance.wgsl" if "scene && instances",
    "shapes/kdtree.wgsl" if "scene && kdtree",
    "geometry/intersect.wgsl" if "scene",
    "geometry/surface.wgsl" if "scene",
    "geometry/instances.wgsl" if "scene && instances",
    "geometry/tangents.wgsl" if "scene && maps || scene && brushed",
    "materials/texture.wgsl" if "scene && textures",
    "materials/maps.wgsl" if "scene && maps",
    "materials/interior.wgsl" if "scene",
    "materials/enclosing.wgsl" if "scene",
    "materials/shading.wgsl" if "scene || gather && lobes",
    "materials/fresnel.wgsl" if "scene && fresnel || gather && fresnel",
    "materials/microfacet.wgsl" if "scene && microfacet || gather && microfacet",
    "lights/shape.wgsl" if "scene && lights",
    "lights/select.wgsl" if "scene && lights",
    "lights/area.wgsl" if "scene && area",
    "lights/point.wgsl" if "scene && point || scene && spot",
    "lights/spot.wgsl" if "scene && spot",
    "lights/sun.wgsl" if "scene && infinite",
    "lights/sun_disc.wgsl" if "scene && sun_disc",
    "lights/image.wgsl" if "scene && environment_image",
    "lights/environment.wgsl" if "scene && environment",
    "lights/light.wgsl" if "scene && lights",
    "lights/guide.wgsl" if "photon_trace && guided",
    "lights/infinity.wgsl" if "photon_trace && infinite",
    "lights/emission.wgsl" if "photon_trace",
    "lights/aim.wgsl" if "photon_trace && far",
    "camera.wgsl" if "eye_trace || aov_trace",
    "kernels/grid.wgsl" if "grid_count || grid_scatter || grid_sort || grid_sort_long || gather",
    "kernels/records.wgsl" if "",
    "kernels/direct.wgsl" if "scene",
    "kernels/scan.wgsl" if "grid_scan_reduce || grid_scan_sums || grid_scan",
    "kernels/eye_path.wgsl" if "eye_trace || aov_trace",
    "kernels/eye_sample.wgsl" if "eye_trace || aov_trace",
    "kernels/eye_trace.wgsl" if "eye_trace",
    "kernels/aov_trace.wgsl" if "aov_trace",
    "kernels/photon_trace.wgsl" if "photon_trace",
    "kernels/grid_count.wgsl" if "grid_count",
    "kernels/grid_scan_reduce.wgsl" if "grid_scan_reduce",
    "kernels/grid_scan_sums.wgsl" if "grid_scan_sums",
    "kernels/grid_scan.wgsl" if "grid_scan",
    "kernels/grid_scatter.wgsl" if "grid_scatter",
    "kernels/sort.wgsl" if "grid_sort || grid_sort_long",
    "kernels/grid_sort.wgsl" if "grid_sort",
    "kernels/grid_sort_long.wgsl" if "grid_sort_long",
    "kernels/gather.wgsl" if "gather",
    "kernels/resolve.wgsl" if "resolve",
    "kernels/resolve_parts.wgsl" if "resolve_parts",
];

/// Names that conditions may use, and those that are true.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// All valid names.
    pub known: BTreeSet<&'static str>,
    /// Names that are true.
    pub held: BTreeSet<&'static str>,
}

impl Names {
    /// Evaluates `condition`; the error names an unknown name.
    pub fn holds(&self, condition: &str) -> Result<bool, String> {
        if condition.is_empty() {
            return Ok(true);
        }
        let mut any = false;
        for alternative in condition.split("||") {
            let mut all = true;
            for name in alternative.split("&&").map(str::trim) {
                if !self.known.contains(name) {
                    return Err(format!("unknown name `{name}` in a condition"));
                }
                all &= self.held.contains(name);
            }
            any |= all;
        }
        Ok(any)
    }
}

/// Returns `text` with the lines of false fences emptied. An error is a line number (from 1) and a
/// description.
pub fn preprocess(text: &str, names: &Names) -> Result<String, (u32, String)> {
    struct Fence {
        opened: u32,
        holds: bool,
        outer: bool,
        has_else: bool,
    }
    let mut fences: Vec<Fence> = Vec::new();
    let mut out = String::with_capacity(text.len());
    let mut live = true;
    for (number, line) in (1u32..).zip(text.lines()) {
        let fence_line = line.trim();
        if let Some(condition) = fence_line.strip_prefix("//#if ") {
            let holds = names.holds(condition.trim()).map_err(|e| (number, e))?;
            fences.push(Fence { opened: number, holds, outer: live, has_else: false });
            live &= holds;
        } else if fence_line == "//#else" {
            let Some(fence) = fences.last_mut().filter(|f| !f.has_else) else {
                return Err((number, "`//#else` without `//#if`".into()));
            };
            fence.has_else = true;
            live = fence.outer && !fence.holds;
        } else if fence_line == "//#end" {
            let Some(fence) = fences.pop() else {
                return Err((number, "`//#end` without `//#if`".into()));
            };
            live = fence.outer;
        } else if fence_line.starts_with("//#") {
            return Err((number, format!("unknown fence `{fence_line}`")));
        } else if live {
            out.push_str(line);
        }
        out.push('\n');
    }
    match fences.pop() {
        Some(fence) => Err((fence.opened, "`//#if` without `//#end`".into())),
        None => Ok(out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Names {
        Names { known: ["a", "b", "c"].into(), held: ["a", "b"].into() }
    }

    /// Fences keep the line count and choose the right branch at every depth.
    #[test]
    fn fences_choose() {
        let text = "0\n//#if a\n1\n//#if c\n2\n//#else\n3\n//#end\n//#else\n4\n//#if a\n5\n\
                    //#end\n//#end\n6\n";
        let out = preprocess(text, &names()).unwrap();
        assert_eq!(out.lines().count(), text.lines().count());
        assert_eq!(out.split_whitespace().collect::<Vec<_>>(), ["0", "1", "3", "6"]);
    }

    /// `&&` has higher precedence than `||`.
    #[test]
    fn conditions() {
        let holds = |c| names().holds(c).unwrap();
        assert!(holds("a && b || c") && holds("c || a && b") && holds("c && a || b"));
        assert!(!holds("c") && !holds("a && c") && !holds("c || c && a"));
    }

    /// Each kind of broken fence is rejected, at its line.
    #[test]
    fn broken_fences() {
        let line = |text| preprocess(text, &names()).unwrap_err().0;
        assert_eq!(line("x\n//#if d\n//#end\n"), 2);
        assert_eq!(line("//#end\n"), 1);
        assert_eq!(line("x\n//#else\n"), 2);
        assert_eq!(line("//#if a\n//#else\n//#else\n//#end\n"), 3);
        assert_eq!(line("x\n//#if a\ny\n"), 2);
        assert_eq!(line("//#if a\n//#endif\n"), 2);
    }
}
