//! Reference (truth) of a study: image files, or long renders with several seeds.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::StudyError;
use super::folder::{Folder, TruthRecord};
use super::grid::Config;
use super::render::{Until, progressive};
use super::statistics::relative_errors;
use crate::device;
use crate::film::metrics::{MetricsError, compare};
use crate::film::{Picture, luminance, read};
use crate::scene::Scene;
use crate::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};

/// Source of the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthSpec {
    /// Independent images with radiance, whose mean is the reference.
    Files(Vec<PathBuf>),
    /// Renders of the study.
    Made {
        /// Method; `None` chooses it by short test renders.
        method: Option<Method>,
        /// Render time in seconds for each lamp size, all seeds together.
        seconds: f64,
        /// Number of independent renders; their scatter determines the error of the reference.
        seeds: u32,
    },
}

/// A reference image and its accuracy.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Radiance.
    pub picture: Picture,
    /// Source and accuracy.
    pub record: TruthRecord,
}

/// First seed of references, far from the seeds of the renders.
const FIRST_SEED: u64 = 1 << 30;
/// Factor by which the error of a method that is not studied may be larger and still be preferred.
const OTHER_METHOD: f64 = 4.0;
/// Relative difference of mean luminance above which one method is assumed to miss light.
const SAME_LIGHT: f64 = 0.02;

/// Mean of K images, and its error: mean squared distance of the images from their mean, divided by
/// K - 1.
pub fn mean_of(pictures: &[Picture], source: String) -> Result<Truth, MetricsError> {
    let Some(first) = pictures.first() else { return Err(MetricsError::Empty) };
    for other in pictures {
        compare(other, first)?;
    }
    let n = pictures.len() as f64;
    let mut pixel = 0..;
    let mean = Picture::from_fn(first.width, first.height, |_, _| {
        let at = pixel.next().unwrap_or(0);
        [0, 1, 2]
            .map(|c| (pictures.iter().map(|p| f64::from(p.rgb[at][c])).sum::<f64>() / n) as f32)
    });
    let (mut variance, mut rel_mse) = (0.0, 0.0);
    for picture in pictures {
        let errors = relative_errors(picture, &mean);
        variance += errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64 / n / (n - 1.0);
        rel_mse += compare(picture, &mean)?.rel_mse / n / (n - 1.0);
    }
    let several = pictures.len() > 1;
    let known = |value: f64| several.then_some(value);
    let record =
        TruthRecord { lamp: None, source, variance: known(variance), rel_mse: known(rel_mse) };
    Ok(Truth { picture: mean, record })
}

/// Reads a reference from files.
pub fn from_files(files: &[PathBuf]) -> Result<Truth, StudyError> {
    let pictures = files.iter().map(|file| read(file)).collect::<Result<Vec<_>, _>>()?;
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    Ok(mean_of(&pictures, names.join(", "))?)
}

/// Renderer of the reference of one scene.
pub struct Maker<'a> {
    /// Scene with the lamp size of the reference.
    pub scene: &'a Scene,
    /// Index of the reference in the study.
    pub number: usize,
    /// Configurations that are compared with the reference.
    pub configs: &'a [&'a Config],
    /// Render time in seconds for all seeds together.
    pub seconds: f64,
    /// Number of seeds.
    pub seeds: u32,
    /// If set, rendering ends early.
    pub interrupted: &'a AtomicBool,
}

impl Maker<'_> {
    /// Renders the seeds of the reference that are missing in the folder. Returns `None` if
    /// interrupted.
    pub fn make(
        &self,
        method: Option<Method>,
        folder: &Folder,
        note: &mut dyn FnMut(&str),
    ) -> Result<Option<Truth>, StudyError> {
        let name = |method: Method, seed: u32| {
            format!("truth/{}-{}-{seed}.pfm", self.number, word(method))
        };
        let begun =
            [Method::Path, Method::Sppm].into_iter().find(|m| folder.file(name(*m, 0)).exists());
        let method = match method.or(begun) {
            Some(method) => method,
            None => match self.choose(note)? {
                Some(method) => method,
                None => return Ok(None),
            },
        };
        let mut pictures = Vec::new();
        for seed in 0..self.seeds {
            let name = name(method, seed);
            let picture = match folder.picture(&name) {
                Some(picture) => picture,
                None => {
                    let seconds = self.seconds / f64::from(self.seeds);
                    let Some(picture) = self.render(method, u64::from(seed), seconds)? else {
                        return Ok(None);
                    };
                    folder.keep_picture(&name, &picture)?;
                    let left = seconds * f64::from(self.seeds - seed - 1);
                    let (method, of) = (word(method), self.seeds);
                    note(&format!(
                        "truth: {method}, seed {} of {of} done; {left:.0} s left",
                        seed + 1
                    ));
                    picture
                }
            };
            pictures.push(picture);
        }
        let source = format!("{}, {} seeds, {:.1} s", described(method), self.seeds, self.seconds);
        Ok(Some(mean_of(&pictures, source)?))
    }

    /// Chooses the method by two short renders of each. Prefers a method that is not studied,
    /// unless it is much noisier or misses light (path tracing finds no caustics of point lights
    /// and hardly any of small lamps).
    fn choose(&self, note: &mut dyn FnMut(&str)) -> Result<Option<Method>, StudyError> {
        let seconds = self.seconds / 20.0;
        let mut pilots = Vec::new();
        for method in [Method::Path, Method::Sppm] {
            let mut pair = Vec::new();
            for seed in 100..102 {
                let Some(picture) = self.render(method, seed, seconds)? else { return Ok(None) };
                pair.push(picture);
            }
            let truth = mean_of(&pair, String::new())?;
            pilots.push((truth.record.rel_mse.unwrap_or(0.0), mean_luminance(&truth.picture)));
        }
        let [(path_error, path_mean), (sppm_error, sppm_mean)] = pilots[..] else {
            return Ok(None);
        };
        let studied =
            |path: bool| self.configs.iter().any(|c| (c.settings.method == Method::Path) == path);
        let same_light = (path_mean / sppm_mean.max(1e-300) - 1.0).abs() < SAME_LIGHT;
        let handicap = match (studied(true), studied(false)) {
            (false, true) => 1.0 / OTHER_METHOD,
            (true, false) => OTHER_METHOD,
            _ => 1.0,
        };
        let method = match same_light && path_error * handicap <= sppm_error {
            true => Method::Path,
            false => Method::Sppm,
        };
        note(&format!(
            "truth: {} (mean of path tracing over that of photon mapping {:.4}, relMSE \
             {path_error:.1e} and {sppm_error:.1e})",
            described(method),
            path_mean / sppm_mean.max(1e-300),
        ));
        Ok(Some(method))
    }

    fn render(
        &self,
        method: Method,
        seed: u64,
        seconds: f64,
    ) -> Result<Option<Picture>, StudyError> {
        let settings = self.settings(method, seed);
        let device = match (method, self.configs.first()) {
            (Method::Path, _) | (_, None) => "cpu",
            (_, Some(config)) => &config.device,
        };
        let mut engine = device::open(&device::parse(device), self.scene, &settings)?.engine;
        let mut picture = None;
        let until = Until::Seconds(seconds);
        let whole = progressive(engine.as_mut(), until, self.interrupted, &mut |s| {
            picture = Some(s.picture)
        })?;
        Ok(picture.filter(|_| whole))
    }

    /// Settings of the reference. Photon mapping starts at a radius of one pixel, so that its bias
    /// blurs less than a pixel.
    fn settings(&self, method: Method, seed: u64) -> RenderSettings {
        let all = || self.configs.iter().map(|config| &config.settings);
        RenderSettings {
            method,
            photons: all().map(|s| s.photons).max().unwrap_or(RenderSettings::default().photons),
            radius: Radius::Pixels(1.0),
            radius_rule: RadiusRule::Global,
            direct: Direct::Sampled,
            max_bounces: all()
                .map(|s| s.max_bounces)
                .max()
                .unwrap_or(RenderSettings::default().max_bounces),
            seed: FIRST_SEED + seed,
            ..RenderSettings::default()
        }
    }
}

fn word(method: Method) -> &'static str {
    match method {
        Method::Sppm => "sppm",
        Method::Ppm => "ppm",
        Method::Path => "path",
    }
}

fn described(method: Method) -> &'static str {
    match method {
        Method::Sppm => "stochastic progressive photon mapping from a radius of 1 pixel",
        Method::Ppm => "progressive photon mapping from a radius of 1 pixel",
        Method::Path => "path tracing",
    }
}

/// Mean luminance of an image.
pub fn mean_luminance(picture: &Picture) -> f64 {
    picture.rgb.iter().map(|rgb| luminance(*rgb)).sum::<f64>() / picture.rgb.len().max(1) as f64
}

/// Theory: the mean of K images with variance V has the variance V / K.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_own_error_is_that_of_a_mean() {
        let mut state = 3u64;
        let mut noisy = || {
            Picture::from_fn(50, 40, |_, _| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                // uniform in [1, 1.1): variance 1/1200
                [1.0 + 0.1 * (state >> 40) as f32 / (1u64 << 24) as f32; 3]
            })
        };
        let pictures: Vec<_> = (0..4).map(|_| noisy()).collect();
        let truth = mean_of(&pictures, String::new()).unwrap();
        let variance = truth.record.variance.unwrap();
        let expected = 1.0 / 4800.0 / (1.05_f64.powi(2) + 0.01);
        assert!((variance / expected - 1.0).abs() < 0.06, "{variance} {expected}");
        let real =
            compare(&truth.picture, &Picture::from_fn(50, 40, |_, _| [1.05; 3])).unwrap().rel_mse;
        let rel_mse = truth.record.rel_mse.unwrap();
        assert!((rel_mse / real - 1.0).abs() < 0.1, "{rel_mse} {real}");
        assert_eq!(mean_of(&pictures[..1], String::new()).unwrap().record.variance, None);
        let other = Picture::from_fn(40, 50, |_, _| [0.0; 3]);
        assert!(mean_of(&[pictures[0].clone(), other], String::new()).is_err());
    }
}
