//! Numerical stability: every row of the table of extremes meets its bound, on the CPU and on the
//! software driver, with smaller samples than `cargo run --release --example stability` uses.

mod bench;
mod counts;
mod grazing;
mod rays;
mod scale;
mod surfaces;
mod table;
mod view;

use crate::support::software;
use bench::{Bench, On};
use table::sections;

/// Measures the rows of a section and reports all that fail.
fn hold(section: &str, on: On) {
    if on == On::Software {
        software();
    }
    let bench = Bench::new(on, false);
    let sections = sections();
    let rows = &sections.iter().find(|(name, _)| *name == section).expect("a section").1;
    let mut failed = Vec::new();
    for row in rows {
        let start = std::time::Instant::now();
        let figure = (row.measure)(&bench);
        let report = format!(
            "{}: {} {:e}, bound {:e} {}",
            row.name, row.unit, figure.value, row.bound, figure.note
        );
        println!("{on:?} {:5.1} s {report}", start.elapsed().as_secs_f64());
        if !row.admits(&figure) {
            failed.push(format!("{report} ({})", row.how));
        }
    }
    assert!(failed.is_empty(), "on {on:?}: {failed:#?}");
}

macro_rules! held {
    ($($test:ident: $section:literal on $device:ident,)*) => {
        $(#[test]
        fn $test() {
            hold($section, On::$device);
        })*
    };
}

held! {
    scale_and_place: "Scale and place" on Cpu,
    scale_and_place_on_driver: "Scale and place" on Software,
    shapes_and_rays: "Shapes and rays" on Cpu,
    shapes_and_rays_on_driver: "Shapes and rays" on Software,
    revolution: "Surfaces of revolution" on Cpu,
    revolution_on_driver: "Surfaces of revolution" on Software,
    radius_counts_means: "Radius, counts and means" on Cpu,
    radius_counts_means_on_driver: "Radius, counts and means" on Software,
    light_film_view: "Light, film and camera" on Cpu,
    light_film_view_on_driver: "Light, film and camera" on Software,
}

/// Theory: NaN and infinity must not pass, whatever the bound.
#[test]
fn no_number_does_not_pass() {
    for (_, rows) in sections() {
        for row in rows {
            assert!(
                !row.admits(&f64::NAN.into()) && !row.admits(&f64::INFINITY.into()),
                "{}",
                row.name
            );
        }
    }
}
