//! Shared by tests of surfaces of revolution: profiles, rays, and an independent solver.

#![allow(dead_code)] // each test binary uses its part

pub mod judge;
pub mod oracle;
pub mod profiles;
pub mod rays;
