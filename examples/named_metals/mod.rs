//! Derivation of the indices of named metals: see `docs/metals.md`.

pub mod fit;
pub mod observer;
pub mod spectra;
