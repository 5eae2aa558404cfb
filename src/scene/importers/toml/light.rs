//! Conversion of lights and the environment.

use super::document::Item;
use super::file::{EnvironmentFile, LightFile};
use crate::scene::builder::SceneBuilder;
use crate::scene::checks::unit;
use crate::scene::parts::Part;
use crate::scene::{Environment, Light};

pub(super) fn light(builder: &mut SceneBuilder, item: &Item, file: LightFile) -> Option<()> {
    let light = match file {
        LightFile::Point { position, intensity } => {
            Light::Point { position: position.into(), intensity: intensity.rgb() }
        }
        LightFile::Spot { position, target, intensity, angle, blend } => Light::Spot {
            position: position.into(),
            target: target.into(),
            intensity: intensity.rgb(),
            angle_degrees: angle,
            blend: blend.0,
        },
        LightFile::Sun { direction, irradiance } => {
            let direction = unit(&mut builder.report, item, "direction", direction)?;
            Light::Sun { direction, irradiance: irradiance.rgb() }
        }
    };
    builder.add_light(item, light);
    Some(())
}

pub(super) fn environment(
    builder: &mut SceneBuilder,
    item: &Item,
    file: &EnvironmentFile,
) -> Option<()> {
    let radiance = file.radiance.map(|radiance| radiance.rgb());
    let environment = if let Some(path) = &file.file {
        Environment::Image {
            image: builder.image(item, path, None)?,
            rotate_degrees: file.rotate.unwrap_or(0.0),
            scale: radiance.unwrap_or([1.0; 3]),
        }
    } else {
        if file.rotate.is_some() {
            let message = "`rotate` has no meaning without a `file`";
            let label = "expected a `file` as well";
            builder.report.error(item.span_of("rotate"), message, label, None);
        }
        if radiance.is_none() {
            let message = "the environment has neither `radiance` nor `file`";
            builder.report.error(item.span(), message, "expected one of them in here", None);
        }
        Environment::Constant { radiance: radiance? }
    };
    builder.set_environment(item, environment);
    Some(())
}
