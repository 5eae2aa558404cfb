//! Writes the meshes and textures of the shipped scenes to assets/:
//!
//!     cargo run --release --example make_assets [FOLDER]

#[path = "make_assets/mod.rs"]
mod assets;

use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets")),
        PathBuf::from,
    );
    std::fs::create_dir_all(&folder)?;
    for asset in assets::all() {
        let bytes = asset.content.to_bytes()?;
        println!("{:>8} bytes  {}", bytes.len(), asset.name);
        std::fs::write(folder.join(asset.name), bytes)?;
    }
    Ok(())
}
