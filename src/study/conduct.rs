//! Runs a study: creates the references and the renders, saves each when it is complete, and can be
//! interrupted between any two passes.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::StudyError;
use super::crop;
use super::folder::{About, Folder, Point, ProductsRecord, Results, RunRecord};
use super::grid::Config;
use super::lamps::Lamp;
use super::render::{Snapshot, Until, progressive};
use super::statistics::Products;
use super::truth::{Maker, Truth, TruthSpec, from_files, mean_luminance};
use super::variant::Variant;
use crate::device::{self, DeviceError};
use crate::film::file::write_rgb8;
use crate::film::flip::ldr_flip;
use crate::film::metrics::compare;
use crate::film::{Development, FileError, Picture, Region};
use crate::render::quality::one_pass_error;
use crate::scene::Scene;

/// Progress event of a study.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Text message.
    Note(String),
    /// A completed render.
    Run {
        /// Number of completed renders.
        done: usize,
        /// Total number of renders.
        of: usize,
        /// Label of the configuration.
        label: String,
        /// Seed number, from 1.
        seed: u32,
        /// Final measurement; `None` if the render failed.
        last: Option<Point>,
        /// Estimated remaining time.
        remaining: Duration,
    },
}

/// A study in progress.
pub struct Study<'a> {
    /// Scene; its film has the image size of the study.
    pub scene: &'a Scene,
    /// Parameters of the study.
    pub about: About,
    /// Folder with the results.
    pub folder: Folder,
    /// Crop to show; `None` selects the one with the most contrast.
    pub crop: Option<Region>,
    /// If set, the study ends early.
    pub interrupted: &'a AtomicBool,
}

/// A configuration with its scene and its reference.
#[derive(Clone, Copy)]
struct GridCell<'a> {
    number: usize,
    config: &'a Config,
    scene: &'a Scene,
    truth: &'a Truth,
    crop: Region,
}

/// Results of a study that ended or was interrupted.
pub struct Conducted {
    /// Results.
    pub results: Results,
    /// Region of the image that the crops show.
    pub crop: Region,
    /// True if all renders are complete.
    pub complete: bool,
}

impl Study<'_> {
    /// Runs all renders that are missing in the folder. If interrupted, returns the results so far.
    ///
    /// # Errors
    /// If a reference cannot be rendered or read, a device does not exist, or a file cannot be
    /// written. Renders that fail are part of the results.
    pub fn conduct(&self, observer: &mut dyn FnMut(&Event)) -> Result<Conducted, StudyError> {
        let whole = Region { x0: 0, y0: 0, x1: self.about.size.0, y1: self.about.size.1 };
        let mut results = Results {
            about: self.about.clone(),
            truths: Vec::new(),
            runs: self.folder.runs(),
            products: self.folder.products(),
        };
        let lamps = self.lamps();
        let mut variants: Vec<Variant> = Vec::new();
        for config in &self.about.configs {
            if !variants.contains(&config.variant) {
                variants.push(config.variant);
            }
        }
        // create all variants before the reference: the scene may lack the shapes to vary
        let scenes = variants.iter().map(|v| v.of(self.scene)).collect::<Result<Vec<_>, _>>()?;
        let mut truths = Vec::new();
        for (number, lamp) in lamps.iter().enumerate() {
            // the reference uses exact surfaces for all other variants
            let exact = Variant { lamp: *lamp, ..Variant::default() }.of(self.scene)?;
            let Some(truth) = self.truth(number, *lamp, &exact, observer)? else {
                return Ok(Conducted {
                    results,
                    crop: self.crop.unwrap_or(whole),
                    complete: false,
                });
            };
            results.truths.push(truth.record.clone());
            truths.push(truth);
        }
        let chosen = self
            .crop
            .or(truths.first().map(|truth| crop::choose(&truth.picture, &self.development())));
        let crop = chosen.unwrap_or(whole);
        for (number, truth) in truths.iter().enumerate() {
            self.write_crop(&format!("crops/truth-{number}.png"), &truth.picture, crop)?;
        }
        let start = Instant::now();
        let mut made = 0;
        let total = self.about.configs.len() * self.about.seeds as usize;
        // Seeds in the outer loop, so that an interrupted study covers all configurations, and
        // temporary load on the machine affects all of them alike.
        for seed in 0..self.about.seeds {
            for (number, config) in self.about.configs.iter().enumerate() {
                let lamp = lamps.iter().position(|lamp| *lamp == config.variant.lamp).unwrap_or(0);
                let scene = variants.iter().position(|v| *v == config.variant).unwrap_or(0);
                let place =
                    GridCell { number, config, scene: &scenes[scene], truth: &truths[lamp], crop };
                if !self.is_done(&results, number, seed) {
                    results.runs.retain(|run| (run.config, run.seed) != (number, seed));
                    let passes = passes_of(&results, number);
                    let Some(run) = self.run(&place, seed, passes)? else {
                        return Ok(Conducted { results, crop, complete: false });
                    };
                    let last = run.points.last().copied();
                    results.runs.push(run);
                    self.folder.keep_runs(&results.runs)?;
                    made += 1;
                    let (done, label) = (results.runs.len(), config.label());
                    let remaining = start.elapsed() / made * total.saturating_sub(done) as u32;
                    observer(&Event::Run {
                        done,
                        of: total,
                        label,
                        seed: seed + 1,
                        last,
                        remaining,
                    });
                }
                if seed + 1 == self.about.seeds {
                    self.finish(&mut results, number, place.truth)?;
                }
            }
        }
        Ok(Conducted { results, crop, complete: true })
    }

    fn development(&self) -> Development {
        Development {
            exposure: self.scene.film.exposure,
            tonemap: self.scene.film.tonemap,
            ..Development::default()
        }
    }

    /// Distinct lamp sizes.
    fn lamps(&self) -> Vec<Option<Lamp>> {
        let mut lamps = Vec::new();
        for config in &self.about.configs {
            if !lamps.contains(&config.variant.lamp) {
                lamps.push(config.variant.lamp);
            }
        }
        lamps
    }

    fn truth(
        &self,
        number: usize,
        lamp: Option<Lamp>,
        scene: &Scene,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Option<Truth>, StudyError> {
        let truth = match &self.about.truth {
            TruthSpec::Files(files) => Some(from_files(files)?),
            TruthSpec::Made { method, seconds, seeds } => {
                let of_lamp =
                    self.about.configs.iter().filter(|config| config.variant.lamp == lamp);
                let configs: Vec<&Config> = of_lamp.collect();
                let (seconds, seeds) = (*seconds, *seeds);
                let interrupted = self.interrupted;
                let maker = Maker { scene, number, configs: &configs, seconds, seeds, interrupted };
                maker.make(*method, &self.folder, &mut |text| {
                    observer(&Event::Note(text.to_owned()))
                })?
            }
        };
        let Some(mut truth) = truth else { return Ok(None) };
        truth.record.lamp = lamp;
        let size = Picture::from_fn(self.about.size.0, self.about.size.1, |_, _| [0.0; 3]);
        compare(&size, &truth.picture)?;
        Ok(Some(truth))
    }

    /// Returns true if a render is complete and its images are still available if they are needed.
    fn is_done(&self, results: &Results, config: usize, seed: u32) -> bool {
        let finished = results.products.iter().any(|p| p.config == config);
        results.runs.iter().filter(|run| (run.config, run.seed) == (config, seed)).any(|run| {
            let kept =
                |point: &Point| self.folder.file(unfinished(config, seed, point.passes)).exists();
            finished || self.about.seeds < 2 || run.points.iter().all(kept)
        })
    }

    /// Renders and measures one seed of a configuration; `None` if interrupted.
    fn run(
        &self,
        place: &GridCell,
        seed: u32,
        passes: Option<u32>,
    ) -> Result<Option<RunRecord>, StudyError> {
        let GridCell { number, config, scene, truth, crop } = *place;
        let mut settings = config.settings.clone();
        settings.seed = settings.seed.wrapping_add(u64::from(seed));
        let start = Instant::now();
        let failed = |what: String, device: &str| RunRecord {
            config: number,
            seed,
            device: device.to_owned(),
            setup_seconds: start.elapsed().as_secs_f64(),
            automatic_radius: None,
            one_pass: None,
            points: Vec::new(),
            failed: Some(what),
        };
        let opened = match device::open(&device::parse(&config.device), scene, &settings) {
            Ok(opened) => opened,
            Err(error @ DeviceError::NoSuchDevice { .. }) => return Err(error.into()),
            Err(error) => return Ok(Some(failed(error.to_string(), &config.device))),
        };
        let automatic_radius = opened.radius.map(|radius| radius.pixels);
        let (name, mut engine) = (opened.name, opened.engine);
        let setup_seconds = start.elapsed().as_secs_f64();
        let until = passes.map_or(Until::Seconds(self.about.run_seconds), Until::Passes);
        let mut snapshots = Vec::new();
        match progressive(engine.as_mut(), until, self.interrupted, &mut |snapshot| {
            snapshots.push(snapshot)
        }) {
            Ok(true) => (),
            Ok(false) => return Ok(None),
            Err(error) => return Ok(Some(failed(error.to_string(), &name))),
        }
        let one_pass = match snapshots.as_slice() {
            [first, both, ..] if both.passes == 2 => {
                one_pass_error(&first.picture, &both.picture).ok()
            }
            _ => None,
        };
        let mut points = Vec::new();
        for snapshot in &snapshots {
            match measure(snapshot, &truth.picture) {
                Ok(point) => points.push(point),
                Err(error) => return Ok(Some(failed(error.to_string(), &name))),
            }
            if self.about.seeds > 1 {
                self.folder
                    .keep_picture(&unfinished(number, seed, snapshot.passes), &snapshot.picture)?;
            }
            if seed == 0 {
                self.write_crop(&crop_name(number, snapshot.passes), &snapshot.picture, crop)?;
            }
        }
        Ok(Some(RunRecord {
            config: number,
            seed,
            device: name,
            setup_seconds,
            automatic_radius,
            one_pass,
            points,
            failed: None,
        }))
    }

    /// Computes the products of the errors of all renders of a configuration, then removes their
    /// images.
    fn finish(
        &self,
        results: &mut Results,
        config: usize,
        truth: &Truth,
    ) -> Result<(), StudyError> {
        if self.about.seeds < 2 || results.products.iter().any(|p| p.config == config) {
            return Ok(());
        }
        let runs: Vec<&RunRecord> =
            results.runs.iter().filter(|run| run.config == config).collect();
        let Some(shortest) = runs.iter().map(|run| &run.points).min_by_key(|points| points.len())
        else {
            return Ok(());
        };
        let mut found = Vec::new();
        for passes in shortest.iter().map(|point| point.passes) {
            let names = (0..self.about.seeds).map(|seed| unfinished(config, seed, passes));
            let pictures: Option<Vec<Picture>> =
                names.map(|name| self.folder.picture(&name)).collect();
            if let Some(pictures) = pictures {
                let products = Products::of(&pictures, &truth.picture);
                found.push(ProductsRecord { config, passes, products });
            }
        }
        let names: Vec<String> = runs
            .iter()
            .flat_map(|run| {
                run.points.iter().map(|point| unfinished(config, run.seed, point.passes))
            })
            .collect();
        results.products.extend(found);
        self.folder.keep_products(&results.products)?;
        names.iter().for_each(|name| self.folder.remove(name));
        Ok(())
    }

    fn write_crop(&self, name: &str, picture: &Picture, crop: Region) -> Result<(), FileError> {
        let development = self.development();
        let part = crop.crop(picture);
        let bytes: Vec<u8> = part.rgb.iter().flat_map(|rgb| development.bytes(*rgb)).collect();
        write_rgb8(&self.folder.file(name), part.width, part.height, &bytes)
    }
}

/// File name of the crop of a configuration's first render.
pub fn crop_name(config: usize, passes: u32) -> String {
    format!("crops/{config}-{passes}.png")
}

fn unfinished(config: usize, seed: u32, passes: u32) -> String {
    format!("unfinished/{config}-{seed}-{passes}.pfm")
}

/// Number of passes of a configuration's first render, which the other seeds repeat.
fn passes_of(results: &Results, config: usize) -> Option<u32> {
    let runs = results.runs.iter().filter(|run| run.config == config);
    runs.filter_map(|run| run.points.last().map(|point| point.passes)).next()
}

fn measure(snapshot: &Snapshot, truth: &Picture) -> Result<Point, StudyError> {
    let picture = &snapshot.picture;
    let comparison = compare(picture, truth)?;
    let flip = ldr_flip(picture, truth)?.mean(&Region::whole(truth));
    Ok(Point {
        passes: snapshot.passes,
        seconds: snapshot.seconds,
        photons: snapshot.photons,
        rays: snapshot.rays,
        mse: comparison.mse,
        rel_mse: comparison.rel_mse,
        flip,
        mean_ratio: mean_luminance(picture) / mean_luminance(truth).max(f64::MIN_POSITIVE),
    })
}
