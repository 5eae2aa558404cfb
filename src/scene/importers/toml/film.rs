//! Conversion of the film and the render settings.

use super::document::Document;
use super::file::{FilmFile, FilterFile, FilterName, FilterTable};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks;
use crate::scene::numbers::WIDEST_FILTER;
use crate::scene::parts::{Absent, Part};
use crate::scene::settings::RenderSettings;
use crate::scene::{Film, PixelFilter};

/// Ratio of the default radius of a Gaussian filter to its standard deviation.
const DEVIATIONS: f64 = 4.0;

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
        filter: filter(file.filter),
        aovs: file.aov.into_iter().collect(),
        window: None,
    };
    let part = item.map_or(&Absent("film") as &dyn Part, |item| item);
    builder.set_film(part, film);
    Some(())
}

fn filter(file: FilterFile) -> PixelFilter {
    let table = match file {
        FilterFile::Table(table) => table,
        FilterFile::Named(FilterName::Box) => FilterTable::Box { radius: None },
        FilterFile::Named(FilterName::Tent) => FilterTable::Tent { radius: None },
        FilterFile::Named(FilterName::Gaussian) => {
            FilterTable::Gaussian { sigma: None, radius: None }
        }
        FilterFile::Named(FilterName::Mitchell) => FilterTable::Mitchell { b: None, c: None },
    };
    match table {
        FilterTable::Box { radius } => {
            PixelFilter::Box { radius: radius.map_or(0.5, |radius| radius.0) }
        }
        FilterTable::Tent { radius } => {
            PixelFilter::Tent { radius: radius.map_or(1.0, |radius| radius.0) }
        }
        FilterTable::Gaussian { sigma, radius } => {
            let sigma = sigma.map_or(0.5, |sigma| sigma.0);
            let default = (DEVIATIONS * sigma).min(WIDEST_FILTER);
            PixelFilter::Gaussian { sigma, radius: radius.map_or(default, |radius| radius.0) }
        }
        FilterTable::Mitchell { b, c } => {
            let third = 1.0 / 3.0;
            PixelFilter::Mitchell { b: b.map_or(third, f64::from), c: c.map_or(third, f64::from) }
        }
    }
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
