//! Host structs have the memory layout of the shaders' structs.
//!
//! Theory: the driver receives naga's offsets and spans, so equality by name with `offset_of!` and
//! `size_of` proves the layout.

use crate::ingredients::Mixture;
use bytemuck::Zeroable;
use caustica::low_level::gpu::compose::compose;
use caustica::low_level::gpu::layout::SceneLayout;
use caustica::low_level::kernels::aov_trace::AovPixel;
use caustica::low_level::kernels::records::*;
use caustica::low_level::kernels::resolve_parts::PartsPixel;
use caustica::low_level::plan::Kernel;
use caustica::low_level::plan::features::Feature;
use caustica::low_level::tables::*;
use std::mem::{offset_of, size_of};

/// Name, size, and offset of each member.
type Layout = (&'static str, usize, Vec<(&'static str, usize)>);

macro_rules! layout {
    ($name:ident { $($field:ident),* }) => {
        (stringify!($name), size_of::<$name>(), vec![$((stringify!($field), offset_of!($name, $field))),*])
    };
}

/// Every host struct that kernels read or write, without padding.
fn hosts() -> Vec<Layout> {
    vec![
        layout!(World {
            bounds_min,
            unit,
            bounds_max,
            near_radius,
            near_center,
            disc_radius,
            light_count,
            environment,
            unbounded_count,
            disc_levels,
            disc_first,
            far,
            nested,
            guided,
            primitive_size,
            body_first,
            body_count,
            sun_discs
        }),
        layout!(Camera {
            position,
            aperture,
            right,
            focus,
            up,
            pixel,
            forward,
            width,
            lens_right,
            height,
            lens_up,
            medium,
            center,
            projection,
            filter_kind,
            filter_size,
            filter_b,
            filter_c
        }),
        layout!(Sphere { anchor, curvature, normal, radius, material, light, uv }),
        layout!(Rectangle {
            origin,
            material,
            normal,
            light,
            u,
            uv,
            v,
            area,
            dual_u,
            outline,
            dual_v
        }),
        layout!(Disc { center, radius, normal, material, light, uv, outline }),
        layout!(Cuboid { lower, material, upper, light, uv, outline }),
        layout!(Plane { point, material, normal, uv, tangent, u0, bitangent, v0, outline }),
        layout!(Revolution {
            x_axis,
            scale,
            y_axis,
            inv_scale,
            z_axis,
            segments,
            center,
            material,
            light,
            uv
        }),
        layout!(Patch {
            revolution,
            segment,
            first_point,
            degree,
            origin,
            axis,
            r_min,
            r_max,
            y_min,
            y_max,
            phi_min,
            phi_max,
            slope,
            length,
            t0,
            t1,
            wobble,
            step_tolerance
        }),
        layout!(Instance {
            row_x,
            group,
            row_y,
            material,
            row_z,
            uv,
            center,
            reach,
            column_x,
            rounding,
            column_y,
            column_z,
            slack
        }),
        layout!(Group { bounds_min, root, bounds_max, first_ref, primitive_size }),
        layout!(Triangle { p0, material, p1, light, p2, attributes }),
        layout!(Attributes { n0, u0, n1, v0, n2, u1, v1, u2, v2, outline_smooth }),
        layout!(Material {
            reflectance,
            kind,
            absorption,
            ior,
            texture,
            alpha,
            planar_origin,
            eta,
            first,
            k,
            second,
            mean_fresnel,
            mean_albedo,
            albedo_low,
            albedo_high,
            stores,
            textured,
            normal_map,
            normal_strength,
            bump_map,
            bump_height,
            bent,
            coated
        }),
        layout!(Texture { scale, kind, flags, first, width, height, format, color0, color1 }),
        layout!(Cell { split, axis, first }),
        layout!(Light {
            color,
            kind,
            position,
            selection,
            direction,
            area,
            reference,
            first,
            outer,
            inner,
            patch_first,
            patch_count,
            medium,
            guide
        }),
        layout!(Dispatch {
            first,
            end,
            pass_number,
            seed,
            chunk_first,
            batch_first,
            key_bits,
            capacity,
            max_bounces,
            eye_samples,
            mask,
            inv_cell,
            scale_sq,
            photons,
            alpha,
            radius_pixels,
            radius_units,
            radius_max,
            strata,
            passes_done,
            classes,
            indirect_radius,
            inv_cell_indirect,
            window_first,
            window_width,
            fixed_points,
            continued,
            bounce_shift,
            points
        }),
        layout!(VisiblePoint {
            position,
            radius,
            weight,
            normal,
            radiance,
            shading,
            reflectance,
            alpha,
            wo,
            outline,
            state,
            bsdf
        }),
        layout!(PhotonRecord { position, key, flux, direction }),
        layout!(Gathered { flux, count, caustic, bias_probe }),
        layout!(Statistics { scale_sq, drop, count_low, count_high }),
        layout!(FilmPixel {
            mean,
            spread,
            carry,
            mean_at_pow2,
            rejected,
            bias_probe,
            bias_probe_alternating,
            halves,
            mean_at_half_pow2
        }),
    ]
}

fn everything() -> (Mixture, naga::Module) {
    everything_of(Kernel::EyeTrace)
}

/// Structs that only the gather reads.
fn hosts_of_gather() -> Vec<Layout> {
    vec![layout!(Outline {
        origin,
        radius,
        u,
        error,
        v,
        walls,
        dual_u,
        margin_s,
        dual_v,
        margin_t
    })]
}

fn everything_of(kernel: Kernel) -> (Mixture, naga::Module) {
    let mixture = Mixture::of(&Feature::all().collect::<Vec<_>>());
    let shader = compose(kernel, &mixture.features(), &SceneLayout::new(&mixture.scene)).unwrap();
    let (module, _) = shader.validate().unwrap();
    (mixture, module)
}

fn members<'a>(module: &'a naga::Module, name: &str) -> Option<(&'a [naga::StructMember], usize)> {
    module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).and_then(|(_, t)| {
        match &t.inner {
            naga::TypeInner::Struct { members, span } => Some((members.as_slice(), *span as usize)),
            _ => None,
        }
    })
}

/// Lists the differences between the hosts' structs and those of the module.
fn differences(module: &naga::Module, hosts: &[Layout]) -> Vec<String> {
    let mut list = Vec::new();
    for (name, size, fields) in hosts {
        let Some((members, span)) = members(module, name) else {
            list.push(format!("no WGSL struct {name}"));
            continue;
        };
        if span != *size {
            list.push(format!("{name}: {size} bytes here, {span} in WGSL"));
        }
        let is_padding =
            |m: &&naga::StructMember| m.name.as_deref().is_some_and(|n| n.starts_with("pad"));
        let shown: Vec<_> = members
            .iter()
            .filter(|m| !is_padding(m))
            .map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize))
            .collect();
        if shown != *fields {
            list.push(format!("{name}: {fields:?} here, {shown:?} in WGSL"));
        }
    }
    list
}

#[test]
fn structs_agree() {
    let (_, module) = everything();
    let mut list = differences(&module, &hosts());
    list.extend(differences(&everything_of(Kernel::Gather).1, &hosts_of_gather()));
    assert!(list.is_empty(), "{}", list.join("\n"));
    // a struct of one kernel only
    let (_, module) = everything_of(Kernel::AovTrace);
    let list = differences(&module, &[aov_pixel()]);
    assert!(list.is_empty(), "{}", list.join("\n"));
    let (_, module) = everything_of(Kernel::ResolveParts);
    let list = differences(&module, &[layout!(PartsPixel { caustic, passes, indirect })]);
    assert!(list.is_empty(), "{}", list.join("\n"));
}

fn aov_pixel() -> Layout {
    layout!(AovPixel {
        albedo,
        depth,
        normal,
        hits,
        position,
        points,
        emission,
        radius,
        direct,
        reference,
        material,
        state
    })
}

/// Every struct in a scene table or a buffer has its host struct in the list.
#[test]
fn no_struct_is_forgotten() {
    let hosts = [hosts(), hosts_of_gather()].concat();
    for (_, module) in [Kernel::EyeTrace, Kernel::Gather].map(everything_of) {
        for (_, variable) in module.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
            let mut open = vec![variable.ty];
            while let Some(ty) = open.pop() {
                let name = module.types[ty].name.as_deref().unwrap_or_default();
                match &module.types[ty].inner {
                    naga::TypeInner::Array { base, .. } => open.push(*base),
                    // `Counters` is read word by word
                    naga::TypeInner::Struct { members, .. } if name != "Counters" => {
                        assert!(
                            name == "SceneTables" || hosts.iter().any(|h| h.0 == name),
                            "{name}"
                        );
                        open.extend(members.iter().map(|m| m.ty));
                    }
                    _ => {}
                }
            }
        }
    }
}

/// The comparison detects a wrong offset, a wrong size, a missing field and a missing struct.
#[test]
fn planted_differences_are_found() {
    let (_, module) = everything();
    let found = |change: fn(&mut Vec<Layout>)| {
        let mut hosts = hosts();
        change(&mut hosts);
        differences(&module, &hosts).len()
    };
    assert_eq!(found(|h| h[2].2[3].1 += 4), 1);
    assert_eq!(found(|h| h[5].1 += 16), 1);
    assert_eq!(found(|h| h[7].2.truncate(3)), 1);
    assert_eq!(found(|h| h[9].0 = "Quadrangle"), 1);
}

/// The scene's tables begin at naga's offsets, and hold the data of the host.
#[test]
fn scene_tables_agree() {
    let (mut mixture, _) = everything();
    // odd lengths, so that each table ends off the alignment
    mixture.scene.unbounded = vec![7, 8, 9];
    mixture.scene.distributions = vec![0.25, 0.5, 0.75, 0.875, 1.0];
    mixture.scene.discs.push(Disc { radius: 3.0, ..Disc::zeroed() });
    let tables = SceneLayout::new(&mixture.scene);
    let shader = compose(Kernel::EyeTrace, &mixture.features(), &tables).unwrap();
    let (module, _) = shader.validate().unwrap();
    let (members, span) = members(&module, "SceneTables").unwrap();
    let theirs: Vec<_> = members
        .iter()
        .map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize))
        .collect();
    let ours: Vec<_> = tables.members.iter().map(|m| (m.name, m.offset)).collect();
    assert_eq!(ours, theirs);
    assert_eq!(tables.bytes.len(), span);
    let offset = |name| ours.iter().find(|(n, _)| *n == name).unwrap().1;
    let word = |at: usize| u32::from_le_bytes(tables.bytes[at..at + 4].try_into().unwrap());
    assert_eq!(word(offset("unbounded") + 8), 9);
    assert_eq!(f32::from_bits(word(offset("distributions") + 12)), 0.875);
    let last_disc = offset("discs") + (mixture.scene.discs.len() - 1) * size_of::<Disc>();
    assert_eq!(f32::from_bits(word(last_disc + offset_of!(Disc, radius))), 3.0);
}
