//! Intersection and the geometry of the gather: kd-tree, triangles, surfaces of revolution and the
//! outlines of flat shapes.

#[path = "../support/brute_force.rs"]
#[allow(dead_code)] // `physics` uses the rest
mod brute_force;
#[path = "../support/revolution/mod.rs"]
mod revolution;
#[path = "../support/mod.rs"]
mod support;

mod instances;
mod kdtree;
mod outlines;
mod revolution_device;
mod revolution_oracle;
mod revolution_surface;
mod revolution_wgsl;
