//! Conversion of the camera, the film and the render settings.

use glam::DVec3;

use super::document::Document;
use super::file::{CameraFile, FilmFile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks;
use crate::scene::parts::{Absent, Part};
use crate::scene::settings::RenderSettings;
use crate::scene::{Camera, Film};

pub(super) fn camera(builder: &mut SceneBuilder, document: &Document) -> Option<()> {
    let item = document.item("camera")?;
    let file: CameraFile = item.read(&mut builder.report)?;
    let (position, target) = (DVec3::from(file.position), DVec3::from(file.target));
    let distance = (target - position).length();
    let (up, aperture) = (DVec3::from(file.up), file.aperture.0);
    let focus = file.focus.map_or(distance, f64::from);
    let camera = Camera { position, target, up, fov_degrees: file.fov, aperture, focus };
    builder.set_camera(item, camera);
    if aperture > 0.0 && file.focus.is_none() {
        let message = "`focus` is missing: a lens with an aperture needs it";
        let help = format!("to focus on the target, write focus = {distance:.6}");
        let label = "expected a `focus` as well";
        builder.report.error(item.span_of("aperture"), message, label, Some(help));
    }
    Some(())
}

pub(super) fn film(builder: &mut SceneBuilder, document: &Document) -> Option<()> {
    let item = document.item("film");
    let file: FilmFile = match item {
        Some(item) => item.read(&mut builder.report)?,
        None => FilmFile::default(),
    };
    let film = Film {
        width: file.width,
        height: file.height,
        exposure: file.exposure,
        tonemap: file.tonemap,
        aovs: file.aov.into_iter().collect(),
        window: None,
    };
    let part = item.map_or(&Absent("film") as &dyn Part, |item| item);
    builder.set_film(part, film);
    Some(())
}

pub(super) fn settings(builder: &mut SceneBuilder, document: &Document) -> Option<()> {
    let item = document.item("render")?;
    for setting in checks::SETTINGS {
        let value = item.node.get(setting.key);
        let entries =
            value.into_iter().flat_map(|value| value.entries().map(|(.., number)| number));
        for node in value.into_iter().chain(entries) {
            // The schema check reports negative counts.
            if let Some(number) = node.number() {
                checks::setting(&mut builder.report, item, &setting, number, node.span());
            }
        }
    }
    let settings: RenderSettings = item.read(&mut builder.report)?;
    builder.set_settings(item, settings);
    Some(())
}
