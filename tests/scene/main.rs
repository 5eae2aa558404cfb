//! Scene files, meshes and textures: what they load as, which errors and warnings they give, and
//! limits on untrusted files.

#[path = "../../examples/make_assets/mod.rs"]
mod assets;
#[path = "../support/mod.rs"]
mod support;

mod encodings;
mod errors;
mod frustums;
mod groups;
mod hostile;
mod limits;
mod load;
mod named;
mod normals;
mod ply;
mod shipped_assets;
mod shipped_scenes;
mod transforms;
