//! The two engines: the CPU engine and the GPU engine on lavapipe give the same bits, share their
//! layouts and shaders, keep to their memory budgets and survive device failures.

#[path = "../support/mod.rs"]
mod support;

mod agreement;
mod cancel;
mod faults;
mod grid_gpu;
mod ingredients;
mod layers;
mod layout;
mod max_bounces;
mod memory;
mod planted;
mod precision;
mod rejections;
mod scenes;
mod shaders;
mod twins;
