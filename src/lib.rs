//! caustica: a photon mapper.
