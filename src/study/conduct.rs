//! Goes through truths and renders, keeps each when it is finished, and can be stopped between any
//! two passes.

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

/// What a watcher is told.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// In words.
    Note(String),
    /// A finished render.
    Run {
        /// How many are finished.
        done: usize,
        /// Of how many.
        of: usize,
        /// The configuration's label and its seed, from 1.
        label: String,
        /// From 1.
        seed: u32,
        /// At its end; none for a render that failed.
        last: Option<Point>,
        /// Time that the rest will take.
        remaining: Duration,
    },
}

/// A study at work.
pub struct Study<'a> {
    /// The scene; its film has the size of the study.
    pub scene: &'a Scene,
    /// What it is about.
    pub about: About,
    /// Where it is kept.
    pub folder: Folder,
    /// The part of the picture to show; none takes the one with most contrast.
    pub crop: Option<Region>,
    /// Set to end it early.
    pub interrupted: &'a AtomicBool,
}

/// A configuration and what its renders are made of and held against.
#[derive(Clone, Copy)]
struct GridCell<'a> {
    number: usize,
    config: &'a Config,
    scene: &'a Scene,
    truth: &'a Truth,
    crop: Region,
}

/// Results, and the truths and the crop that belong to them.
pub struct Conducted {
    /// All that was found.
    pub results: Results,
    /// The part of the picture that the crops show.
    pub crop: Region,
    /// Whether all renders are finished.
    pub complete: bool,
}

impl Study<'_> {
    /// Makes what is missing. Gives what there is when it is interrupted.
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
        // All of them before the truth, since a scene may lack what is to be varied.
        let scenes = variants.iter().map(|v| v.of(self.scene)).collect::<Result<Vec<_>, _>>()?;
        let mut truths = Vec::new();
        for (number, lamp) in lamps.iter().enumerate() {
            // Whatever else is varied is held against the exact surfaces.
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
        // Seed by seed, so that a study that is stopped has something of everything, and so that
        // what else the machine does in a while falls on all alike.
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

    /// Sizes of the lamps, each once.
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

    /// Whether a render is finished and, as long as its configuration is not, its pictures are
    /// there.
    fn is_done(&self, results: &Results, config: usize, seed: u32) -> bool {
        let finished = results.products.iter().any(|p| p.config == config);
        results.runs.iter().filter(|run| (run.config, run.seed) == (config, seed)).any(|run| {
            let kept =
                |point: &Point| self.folder.file(unfinished(config, seed, point.passes)).exists();
            finished || self.about.seeds < 2 || run.points.iter().all(kept)
        })
    }

    /// One render, measured; none where it was interrupted.
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

    /// When all renders of a configuration are there: the products of their errors, after which the
    /// pictures can go.
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

/// Name of the crop of a configuration's first render.
pub fn crop_name(config: usize, passes: u32) -> String {
    format!("crops/{config}-{passes}.png")
}

fn unfinished(config: usize, seed: u32, passes: u32) -> String {
    format!("unfinished/{config}-{seed}-{passes}.pfm")
}

/// Passes that a configuration's first render made in its time; the others make as many.
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
