//! Conversion and checks of the camera, film, render settings, lights and environment.

use glam::DVec3;

use super::file::{CameraFile, EnvironmentFile, FilmFile, LightFile};
use super::limits::within;
use super::load::Loader;
use super::numbers::{LARGEST, SMALLEST};
use super::validate::Item;
use super::{Camera, Environment, Film, Light};
use crate::scene::settings::RenderSettings;

/// Sine of the angle below which two directions count as parallel.
const LEAST_SINE: f64 = 1e-9;

pub(super) fn camera(loader: &mut Loader) -> Option<Camera> {
    let item = loader.document.item("camera")?;
    let file: CameraFile = item.read(loader.report)?;
    let position = DVec3::from(file.position);
    let target = DVec3::from(file.target);
    let up = DVec3::from(file.up);
    let view = target - position;
    if view.length() == 0.0 {
        let message = "the camera's target is its position";
        loader.report.error(item.node.span_of("target"), message, "expected another point", None);
    } else if up.length() == 0.0 {
        let message = "`camera.up` has length 0";
        loader.report.error(item.node.span_of("up"), message, "expected a direction", None);
    } else if view.normalize().cross(up.normalize()).length() < LEAST_SINE {
        let message = "`camera.up` is parallel to the view direction";
        let help = Some("turn it: [0, 0, -1] suits a camera that looks straight down".to_owned());
        loader.report.error(item.node.span_of("up"), message, "expected another direction", help);
    }
    let aperture = file.aperture.0;
    if aperture > 0.0 && file.focus.is_none() {
        let message = "`focus` is missing: a lens with an aperture needs it";
        let help = format!("to focus on the target, write focus = {:.6}", view.length());
        let label = "expected a `focus` as well";
        loader.report.error(item.node.span_of("aperture"), message, label, Some(help));
    }
    let focus = file.focus.map_or(view.length(), f64::from);
    Some(Camera { position, target, up, fov_degrees: file.fov, aperture, focus })
}

pub(super) fn film(loader: &mut Loader) -> Option<Film> {
    let file = match loader.document.item("film") {
        Some(item) => item.read(loader.report)?,
        None => FilmFile::default(),
    };
    let pixels = u64::from(file.width) * u64::from(file.height);
    if let Err(refusal) =
        within("picture-pixels", "pixels", pixels, loader.allowance.picture_pixels)
    {
        let span = loader.document.item("film").map_or(0..0, |item| item.node.span_of("width"));
        let message = format!("the image is too large: {refusal}");
        loader.report.error(span, message, "expected fewer pixels", refusal.help());
    }
    Some(Film {
        width: file.width,
        height: file.height,
        exposure: file.exposure,
        tonemap: file.tonemap,
        aovs: file.aov.into_iter().collect(),
        window: None,
    })
}

pub(super) fn settings(loader: &mut Loader) -> Option<RenderSettings> {
    let Some(item) = loader.document.item("render") else {
        return Some(RenderSettings::default());
    };
    let mut require = |key: &str, expected: &str, holds: fn(f64) -> bool| {
        let value = item.node.get(key);
        let entries =
            value.into_iter().flat_map(|value| value.entries().map(|(.., number)| number));
        for node in value.into_iter().chain(entries) {
            // The schema check reports negative counts.
            if node.number().is_some_and(|number| number.is_finite() && !holds(number)) {
                let message = format!("`render.{key}` is out of range");
                let label = format!("expected {expected}");
                loader.report.error(node.span(), message, label, None);
            }
        }
    };
    for count in ["passes", "photons", "batch"] {
        require(count, "at least 1", |count| count != 0.0);
    }
    require("radius", "a number from 1e-15 to 1e15", |radius| {
        (SMALLEST..=LARGEST).contains(&radius)
    });
    require("indirect_radius", "a number from 1 to 16", |times| (1.0..=16.0).contains(&times));
    require("alpha", "a number greater than 0 and at most 1", |alpha| alpha > 0.0 && alpha <= 1.0);
    item.read(loader.report)
}

pub(super) fn light(loader: &mut Loader, item: &Item, file: LightFile) -> Option<Light> {
    let (light, power_key, power) = match file {
        LightFile::Point { position, intensity } => {
            let light = Light::Point { position: position.into(), intensity: intensity.rgb() };
            (light, "intensity", intensity.rgb())
        }
        LightFile::Spot { position, target, intensity, angle, blend } => {
            if position == target {
                let message = format!("the target of {} is its position", item.path);
                let label = "expected another point";
                loader.report.error(item.node.span_of("target"), message, label, None);
            }
            let light = Light::Spot {
                position: position.into(),
                target: target.into(),
                intensity: intensity.rgb(),
                angle_degrees: angle,
                blend: blend.0,
            };
            (light, "intensity", intensity.rgb())
        }
        LightFile::Sun { direction, irradiance } => {
            let direction = unit(loader, item, "direction", direction)?;
            let light = Light::Sun { direction, irradiance: irradiance.rgb() };
            (light, "irradiance", irradiance.rgb())
        }
    };
    if power.iter().all(|&channel| channel == 0.0) {
        let message = format!("{} emits no light", item.path);
        loader.report.warn(item.node.span_of(power_key), message, "zero in every channel");
    }
    Some(light)
}

pub(super) fn environment(
    loader: &mut Loader,
    item: &Item,
    file: &EnvironmentFile,
) -> Option<Environment> {
    let radiance = file.radiance.map(|radiance| radiance.rgb());
    let Some(path) = &file.file else {
        if file.rotate.is_some() {
            let message = "`rotate` has no meaning without a `file`";
            loader.report.error(
                item.node.span_of("rotate"),
                message,
                "expected a `file` as well",
                None,
            );
        }
        if radiance.is_none() {
            let message = "the environment has neither `radiance` nor `file`";
            loader.report.error(item.node.span(), message, "expected one of them in here", None);
        }
        return Some(Environment::Constant { radiance: radiance? });
    };
    let image = loader.image(item, path, None)?;
    Some(Environment::Image {
        image,
        rotate_degrees: file.rotate.unwrap_or(0.0),
        scale: radiance.unwrap_or([1.0; 3]),
    })
}

/// Normalizes a direction; reports an error if its length is 0 or not finite.
pub(super) fn unit(
    loader: &mut Loader,
    item: &Item,
    key: &str,
    direction: [f64; 3],
) -> Option<DVec3> {
    let unit = DVec3::from(direction).try_normalize();
    if unit.is_none() {
        let message = format!("`{}.{key}` has no direction", item.path);
        let label = "expected a vector of a length that is neither 0 nor infinite";
        loader.report.error(item.node.span_of(key), message, label, None);
    }
    unit
}
