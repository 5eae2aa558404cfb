//! Light transport against closed forms and reference images, numerical stability, and the error
//! estimate.
//!
//! A test states its theory, renders the scene in-process with several seeds, and compares region
//! means with the answer by a t-test (see [`lab`]).
//!
//! `CAUSTICA_DEVICE` selects the device (default `cpu`).

#[path = "../support/brute_force.rs"]
#[allow(dead_code)] // `geometry` uses the rest
mod brute_force;
#[path = "../support/revolution/mod.rs"]
mod revolution;
#[path = "../support/mod.rs"]
mod support;

mod agreement;
mod bent_normals;
mod cameras;
mod caustics;
mod closed_forms;
mod convergence;
mod densities;
mod dielectrics;
mod directions;
mod distant;
mod energy;
mod error_estimate;
mod everything;
mod far_ground;
mod furnace;
mod instances;
mod integrating_sphere;
mod invariance;
mod irradiance;
mod lab;
mod maps;
mod materials;
mod media;
mod meshes;
mod pixel_filters;
mod principled;
mod stability;
mod sun_discs;
mod truth;
mod walls;
