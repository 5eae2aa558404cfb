//! Grid of settings of a study.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use super::variant::Variant;
use crate::scene::numbers::{LARGEST, SMALLEST};
use crate::scene::settings::{Radius, RenderSettings};

/// Settings that a grid may vary, with examples of their values.
pub const NAMES: [(&str, &str); 13] = [
    ("method", "sppm,ppm,path"),
    ("radius_rule", "global,local,fixed"),
    ("alpha", "0.5,0.66,0.8"),
    ("radius", "auto,2px,0.01"),
    ("indirect_radius", "1,2,4"),
    ("photons", "65536,262144"),
    ("direct", "sampled,photons"),
    ("max_bounces", "4,8,32"),
    ("eye_samples", "1,4"),
    ("device", "cpu,cpu-f64,software"),
    ("lamp_area", "1,1e-2,1e-4,point"),
    ("revolutions", "exact,32,128"),
    ("newton_tolerance", "least,1e-4,1e-2"),
];

/// A setting and the values to try.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// One of [`NAMES`].
    pub name: String,
    /// Values as written by the user.
    pub values: Vec<String>,
}

/// An invalid axis or value.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GridError {
    /// Not of the form NAME=V1,V2.
    #[error("`{0}`: expected a setting and its values, e.g. radius=1px,2px")]
    Form(String),
    /// Unknown setting.
    #[error(
        "unknown setting `{name}`{}; a study may vary {known}",
        near.map(|n| format!(", did you mean `{n}`?")).unwrap_or_default()
    )]
    Name {
        /// Name as written by the user.
        name: String,
        /// The most similar known name, if one is similar.
        near: Option<&'static str>,
        /// All known names.
        known: String,
    },
    /// Invalid value of a setting.
    #[error("{name}={value}: {what}")]
    Value {
        /// Name of the setting.
        name: String,
        /// Value as written by the user.
        value: String,
        /// Description of the problem.
        what: String,
    },
}

impl FromStr for Axis {
    type Err = GridError;

    fn from_str(text: &str) -> Result<Self, GridError> {
        let form = || GridError::Form(text.to_owned());
        let (name, values) = text.split_once('=').ok_or_else(form)?;
        let name = name.trim().replace('-', "_");
        let values: Vec<String> = values.split(',').map(|value| value.trim().to_owned()).collect();
        if values.iter().any(String::is_empty) {
            return Err(form());
        }
        if !NAMES.iter().any(|(known, _)| *known == name) {
            let nearest = NAMES
                .iter()
                .map(|(known, _)| (strsim::damerau_levenshtein(known, &name), *known))
                .min();
            let near = nearest
                .filter(|(distance, known)| *distance <= known.len() / 3)
                .map(|(_, known)| known);
            return Err(GridError::Name {
                name,
                near,
                known: NAMES.map(|(known, _)| known).join(", "),
            });
        }
        // check each value independently of its combinations
        let mut any = Config::new(RenderSettings::default(), "auto");
        values.iter().try_for_each(|value| any.set(&name, value))?;
        Ok(Self { name, values })
    }
}

/// A configuration, i.e. a point of the grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// Settings chosen by the grid, as (name, value).
    pub choices: Vec<(String, String)>,
    /// All settings.
    pub settings: RenderSettings,
    /// Device, as a value of `--device`.
    pub device: String,
    /// Modification of the scene.
    pub variant: Variant,
    /// Label of the settings without choices.
    #[serde(default = "scene_itself")]
    pub base: String,
}

fn scene_itself() -> String {
    "scene settings".to_owned()
}

impl Config {
    /// Configuration of the unmodified scene with these settings.
    pub fn new(settings: RenderSettings, device: &str) -> Self {
        let (device, base) = (device.to_owned(), scene_itself());
        Self { choices: Vec::new(), settings, device, variant: Variant::default(), base }
    }

    /// Adds a choice.
    fn with(&self, name: &str, value: &str) -> Result<Self, GridError> {
        let mut config = self.clone();
        config.set(name, value)?;
        config.choices.push((name.to_owned(), value.to_owned()));
        Ok(config)
    }

    fn set(&mut self, name: &str, text: &str) -> Result<(), GridError> {
        let fault =
            |what: String| GridError::Value { name: name.to_owned(), value: text.to_owned(), what };
        match name {
            "device" => self.device = text.to_owned(),
            "lamp_area" => self.variant.lamp = Some(text.parse().map_err(fault)?),
            "revolutions" => self.variant.revolutions = text.parse().map_err(fault)?,
            "newton_tolerance" => self.variant.newton = text.parse().map_err(fault)?,
            "radius" => self.settings.radius = radius(text).map_err(fault)?,
            _ => self.settings = with_setting(&self.settings, name, text).map_err(fault)?,
        }
        Ok(())
    }

    /// Value that the grid chose for a setting, if any.
    pub fn choice(&self, name: &str) -> Option<&str> {
        self.choices.iter().find(|(choice, _)| choice == name).map(|(_, value)| value.as_str())
    }

    /// Short label within the study.
    pub fn label(&self) -> String {
        match self.choices.as_slice() {
            [] => self.base.clone(),
            choices => choices
                .iter()
                .map(|(name, value)| label(name, value))
                .collect::<Vec<_>>()
                .join(", "),
        }
    }

    /// Value of a setting of [`NAMES`], in the notation of a grid.
    pub fn value(&self, name: &str) -> String {
        match (name, self.settings.radius) {
            ("device", _) => self.device.clone(),
            ("lamp_area", _) => self.variant.lamp.map_or("own".to_owned(), |lamp| lamp.to_string()),
            ("revolutions", _) => self.variant.revolutions.to_string(),
            ("newton_tolerance", _) => self.variant.newton.to_string(),
            ("radius", Radius::Auto) => "auto".to_owned(),
            ("radius", Radius::Pixels(r)) => format!("{r}px"),
            ("radius", Radius::Units(r)) => format!("{r}"),
            ("indirect_radius", Radius::Auto) if self.settings.indirect_radius.is_none() => {
                "auto".to_owned()
            }
            ("indirect_radius", _) => format!("{}", self.settings.wider()),
            _ => {
                match serde_json::to_value(&self.settings).map(|settings| settings[name].clone()) {
                    Ok(Value::String(word)) => word,
                    Ok(Value::Number(number)) => format!("{:.4}", number.as_f64().unwrap_or(0.0))
                        .trim_end_matches('0')
                        .trim_end_matches('.')
                        .to_owned(),
                    _ => String::new(),
                }
            }
        }
    }

    /// Label that omits some settings.
    pub fn label_without(&self, left_out: &[&str]) -> String {
        let rest = self.choices.iter().filter(|(name, _)| !left_out.contains(&name.as_str()));
        let rest: Vec<_> = rest.cloned().collect();
        Self { choices: rest, ..self.clone() }.label()
    }
}

/// Short label of a value of a setting.
pub fn label(name: &str, value: &str) -> String {
    match name {
        "method" | "device" => value.to_owned(),
        "radius_rule" => format!("{value} rule"),
        "alpha" => format!("α {value}"),
        "radius" => format!("r {value}"),
        "indirect_radius" => format!("indirect r × {value}"),
        "photons" => format!("{} photons", value.parse().map_or(value.to_owned(), thousands)),
        "direct" => match value {
            "photons" => "direct by photons".to_owned(),
            _ => format!("direct {value}"),
        },
        "max_bounces" => format!("{value} bounces"),
        "eye_samples" => format!("{value} eye samples"),
        "lamp_area" => match value {
            "point" => "point lamp".to_owned(),
            _ => format!("lamp {value}"),
        },
        "revolutions" => match value {
            "exact" => "exact surfaces".to_owned(),
            _ => format!("meshes of {value} sectors"),
        },
        "newton_tolerance" => match value {
            "least" => "least Newton tolerance".to_owned(),
            _ => format!("Newton tolerance {value}"),
        },
        _ => format!("{name} {value}"),
    }
}

/// Formats 65536 as 66k.
fn thousands(number: f64) -> String {
    match number {
        n if n >= 999_500.0 => format!("{:.1}M", n / 1e6),
        n if n >= 10_000.0 => format!("{:.0}k", n / 1e3),
        n if n >= 1_000.0 => format!("{:.1}k", n / 1e3),
        n => format!("{n}"),
    }
}

/// All combinations of the values of `product`, and in addition each value of `varied` applied to
/// `base` alone.
pub fn configs(base: &Config, product: &[Axis], varied: &[Axis]) -> Result<Vec<Config>, GridError> {
    let mut configs = vec![base.clone()];
    for axis in product {
        let combine = |config: &Config| {
            axis.values.iter().map(|v| config.with(&axis.name, v)).collect::<Vec<_>>()
        };
        configs = configs.iter().flat_map(combine).collect::<Result<_, _>>()?;
    }
    for axis in varied {
        for value in &axis.values {
            let config = base.with(&axis.name, value)?;
            let same = |other: &Config| {
                (&other.settings, &other.device, &other.variant)
                    == (&config.settings, &config.device, &config.variant)
            };
            if !configs.iter().any(same) {
                configs.push(config);
            }
        }
    }
    Ok(configs)
}

/// Default axes: the most important settings, each varied alone.
pub fn default_axes(base: &RenderSettings) -> Vec<Axis> {
    let axis = |name: &str, values: Vec<String>| Axis { name: name.to_owned(), values };
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let times = |factor: f64| match base.radius {
        // close to the automatic radius of most scenes
        Radius::Auto => format!("{}px", 4.0 * factor),
        Radius::Pixels(r) => format!("{}px", r * factor),
        Radius::Units(r) => format!("{}", r * factor),
    };
    let photons = |factor: f64| ((f64::from(base.photons) * factor) as u32).max(1).to_string();
    vec![
        axis("method", words(&["sppm", "ppm", "path"])),
        axis("radius_rule", words(&["global", "local", "fixed"])),
        axis("radius", vec![times(0.5), times(2.0), times(4.0)]),
        axis("photons", vec![photons(0.25), photons(4.0)]),
        axis("direct", words(&["sampled", "photons"])),
        axis("alpha", words(&["0.5", "0.8"])),
    ]
}

fn radius(text: &str) -> Result<Radius, String> {
    if text == "auto" {
        return Ok(Radius::Auto);
    }
    let (number, unit): (_, fn(f64) -> Radius) = match text.strip_suffix("px") {
        Some(pixels) => (pixels, Radius::Pixels),
        None => (text, Radius::Units),
    };
    let number = number.parse().ok().filter(|number| (SMALLEST..=LARGEST).contains(number));
    number.map(unit).ok_or("expected auto, pixels (2px) or scene units (0.01)".to_owned())
}

/// Sets a field of the settings from text in the notation of scene files.
fn with_setting(
    settings: &RenderSettings,
    name: &str,
    text: &str,
) -> Result<RenderSettings, String> {
    let value = match text.parse::<f64>() {
        Ok(number) if number.fract() == 0.0 && (0.0..1e15).contains(&number) => {
            Value::from(number as u64)
        }
        Ok(number) => Value::from(number),
        Err(_) => Value::from(text),
    };
    let mut object = serde_json::to_value(settings).map_err(|error| error.to_string())?;
    object[name] = value;
    let changed: RenderSettings =
        serde_json::from_value(object).map_err(|error| error.to_string())?;
    let within = |least: u32, value: u32, most: u32| match (least..=most).contains(&value) {
        true => Ok(()),
        false => Err(format!("expected a whole number from {least} to {most}")),
    };
    within(1, changed.photons, u32::MAX)?;
    if !(1.0..=16.0).contains(&changed.wider()) {
        return Err("expected a number from 1 to 16".to_owned());
    }
    within(0, changed.max_bounces, 65535)?;
    within(1, changed.eye_samples, 65536)?;
    match changed.alpha > 0.0 && changed.alpha <= 1.0 {
        true => Ok(changed),
        false => Err("expected a number above 0 and up to 1".to_owned()),
    }
}

/// Theory: a grid is a product, a variation is a star around the base settings.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::settings::{Method, RadiusRule};

    fn axes(texts: &[&str]) -> Vec<Axis> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn products_and_stars() {
        let base = Config::new(RenderSettings::default(), "cpu");
        let all = configs(&base, &axes(&["radius_rule=global,local", "photons=1e4,2e4,4e4"]), &[])
            .unwrap();
        assert_eq!(all.len(), 6);
        assert_eq!(
            (all[5].settings.radius_rule, all[5].settings.photons),
            (RadiusRule::Local, 40_000)
        );
        assert_eq!(all[5].label(), "local rule, 40k photons");
        assert_eq!(all[5].label_without(&["radius_rule"]), "40k photons");
        // the base occurs once, since sppm is the default
        let star = configs(&base, &[], &axes(&["method=sppm,path", "radius=1px,0.02"])).unwrap();
        let labels: Vec<_> = star.iter().map(Config::label).collect();
        assert_eq!(labels, ["scene settings", "path", "r 1px", "r 0.02"]);
        assert_eq!(star[1].settings.method, Method::Path);
        assert_eq!(star[2].settings.method, Method::Sppm);
        // variants of the scene are different configurations
        let star = configs(
            &base,
            &[],
            &axes(&["revolutions=exact,16", "newton_tolerance=1e-3", "lamp_area=point"]),
        );
        let labels: Vec<_> = star.unwrap().iter().map(Config::label).collect();
        assert_eq!(
            labels,
            ["scene settings", "meshes of 16 sectors", "Newton tolerance 1e-3", "point lamp"]
        );
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let fault = |text: &str| text.parse::<Axis>().unwrap_err().to_string();
        assert!(fault("radius").contains("radius=1px,2px"));
        assert!(fault("radius=1px,").contains("expected"));
        assert!(fault("radios=1px").contains("did you mean `radius`"));
        assert!(fault("revolution=64").contains("did you mean `revolutions`"));
        assert!(fault("revolutions=2").contains("exact, or a number of sectors from 3 to 4096"));
        assert!(fault("newton_tolerance=0").contains("least, or a length from 1e-7 to 1"));
        assert!(fault("seed=1").contains("a study may vary method, "));
        for bad in [
            "alpha=0",
            "alpha=1.5",
            "photons=0",
            "photons=1.5",
            "photons=-1",
            "radius=0",
            "radius=nan",
            "max_bounces=70000",
            "method=pmp",
            "direct=1",
            "lamp_area=-1",
            "lamp_area=dot",
            "revolutions=2",
            "revolutions=5000",
            "revolutions=round",
            "newton_tolerance=0",
            "newton_tolerance=2",
            "alpha=nan",
        ] {
            assert!(bad.parse::<Axis>().is_err(), "{bad}");
        }
    }

    #[test]
    fn the_default_is_a_small_star() {
        let settings = RenderSettings::default();
        let base = Config::new(settings.clone(), "cpu");
        let all = configs(&base, &[], &default_axes(&settings)).unwrap();
        assert!((8..=16).contains(&all.len()), "{}", all.len());
        assert!(all.iter().all(|config| config.choices.len() <= 1));
    }
}
