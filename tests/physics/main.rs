//! Light transport against closed forms: every test states its theory first, renders the scene
//! in-process with several seeds, and holds region means against the answer within a t-test's
//! interval (see [`lab`]).
//!
//! `CAUSTICA_DEVICE` chooses the device (default `cpu`).

#[path = "../support/brute_force.rs"]
#[allow(dead_code)] // `geometry` uses the rest
mod brute_force;
#[path = "../support/revolution/mod.rs"]
mod revolution;
#[path = "../support/mod.rs"]
mod support;

mod agreement;
mod bent_normals;
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
mod integrating_sphere;
mod invariance;
mod irradiance;
mod lab;
mod materials;
mod media;
mod meshes;
mod stability;
mod truth;
mod walls;
