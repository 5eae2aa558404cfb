//! Benchmark figures as text tables.

use caustica::low_level::bench::machine::Machine;
use caustica::low_level::bench::spread::Spread;
use caustica::low_level::bench::to_error::Approach;
use caustica::low_level::bench::{DeviceReport, KernelReport, SliceReport};
use caustica::low_level::plan::Kernel;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;

use super::progress::count;

/// Heading with the scene, the settings and the machine.
pub fn heading(scene: &Scene, settings: &RenderSettings, machine: &Machine) -> String {
    let Machine { os, architecture, processor, threads } = machine;
    let processor = processor.as_ref().map(|name| format!(", {name}")).unwrap_or_default();
    format!(
        "caustica {}: {}, {} x {} pixels, {} photons per pass\n\
         on {os}, {architecture}{processor}, {threads} threads",
        env!("CARGO_PKG_VERSION"),
        scene.name,
        scene.film.width,
        scene.film.height,
        settings.photons
    )
}

/// Figures of a device.
pub fn device_text(report: &DeviceReport) -> String {
    let mut lines = vec![
        String::new(),
        format!("{} [{}] {}", report.name, report.kind, report.driver),
        format!(
            "{} passes after {} warm-up passes; kernels timed by {}",
            report.pass.count, report.warm_up, report.clock
        ),
        String::new(),
    ];
    lines.extend(kernel_table(report));
    lines.push(String::new());
    let rate = |name: &str| count(report.rates.get(name).copied().unwrap_or_default());
    lines.push(format!(
        "a pass takes {}: {} rays/s, {} photon and eye paths/s",
        spread(&report.pass),
        rate("rays_per_second"),
        rate("paths_per_second"),
    ));
    let setup = &report.setup;
    lines.push(format!(
        "setup: tables {}, plan {}, engine {}; first pass {}",
        time(setup.pack),
        time(setup.plan),
        time(setup.engine),
        time(report.first_pass)
    ));
    lines.extend(report.slices.iter().map(slice_line));
    let memory = &report.memory;
    let peak =
        memory.peak_resident.map(|bytes| format!(", {}B peak resident", count(bytes as f64)));
    lines.push(format!(
        "memory: {:.0} bytes per pixel, {:.0} bytes per photon, {:.0} bytes per record{}",
        memory.per_pixel,
        memory.per_photon,
        memory.per_record,
        peak.unwrap_or_default()
    ));
    lines.extend(report.to_error.iter().filter_map(approach_line));
    lines.join("\n")
}

fn kernel_table(report: &DeviceReport) -> Vec<String> {
    let compiled = !report.compile.is_empty();
    let mut heading = format!("{:<17}", "kernel");
    if compiled {
        heading += &format!("{:>10}{:>10}", "check", "driver");
    }
    heading += &format!("{:>10}{:>20}{:>7}   {}", "median", "min to max", "share", "per second");
    let stems = Kernel::ALL.map(Kernel::stem);
    let known = stems.iter().chain([&"path_trace"]).filter_map(|stem| {
        let kernel = report.kernels.get(stem)?;
        Some((*stem, kernel))
    });
    let mut lines = vec![heading];
    lines.extend(known.map(|(stem, kernel)| {
        let mut line = format!("{stem:<17}");
        if compiled {
            let cell = |seconds: Option<f64>| seconds.map_or("-".to_owned(), time);
            let compile = report.compile.get(stem);
            line += &format!(
                "{:>10}{:>10}",
                cell(compile.map(|c| c.checking)),
                cell(compile.map(|c| c.driver))
            );
        }
        line + &kernel_cells(kernel)
    }));
    let sum: f64 = report.kernels.values().map(|kernel| kernel.seconds.median).sum();
    let blank = if compiled {
        let all = |part: fn(&caustica::low_level::bench::Compile) -> f64| {
            report.compile.values().map(part).sum()
        };
        format!("{:>10}{:>10}", time(all(|c| c.checking)), time(all(|c| c.driver)))
    } else {
        String::new()
    };
    lines.push(format!("{:<17}{blank}{:>10}", "all kernels", time(sum)));
    lines.push(format!(
        "{:<17}{:width$}{:>10}",
        "other",
        "",
        time(report.rest.median),
        width = blank.len()
    ));
    lines
}

fn kernel_cells(kernel: &KernelReport) -> String {
    let seconds = &kernel.seconds;
    let range = format!("{} to {}", time(seconds.least), time(seconds.most));
    let rates = kernel.rates.iter().map(|(name, rate)| {
        let what = name.trim_end_matches("_per_second").replace('_', " ");
        format!("{} {what}", count(*rate).trim_end())
    });
    let rates: Vec<String> = rates.collect();
    format!(
        "{:>10}{range:>20}{:>5.0} %   {}",
        time(seconds.median),
        100.0 * kernel.share,
        rates.join(", ")
    )
}

fn slice_line(slice: &SliceReport) -> String {
    let name =
        slice.slice.map_or("not split".to_owned(), |seconds| format!("split at {}", time(seconds)));
    let loss = match (slice.slice, slice.loss) {
        (Some(_), Some(loss)) => format!(", {:+.1} % due to splitting", 100.0 * loss),
        _ => String::new(),
    };
    format!(
        "{name}: a pass takes {}{loss}; {:.1} submissions, the longest {} ({})",
        spread(&slice.pass),
        slice.submissions,
        time(slice.longest),
        slice.longest_kernels.join(", ")
    )
}

fn approach_line(approach: &Approach) -> Option<String> {
    let last = approach.series.last()?;
    let place = approach.region.as_ref().map(|name| format!(" of {name}")).unwrap_or_default();
    let end = format!(
        "relMSE{place} {:.3e} after {} passes, {}",
        last.rel_mse,
        last.passes,
        time(last.seconds)
    );
    Some(match (approach.goal, approach.reached_seconds) {
        (None, _) => end,
        (Some(goal), Some(seconds)) => {
            format!("time to relMSE{place} {goal}: {} ({end})", time(seconds))
        }
        (Some(goal), None) => format!("relMSE{place} {goal} was not reached ({end})"),
    })
}

fn spread(seconds: &Spread) -> String {
    format!("{} ({} to {})", time(seconds.median), time(seconds.least), time(seconds.most))
}

/// Formats seconds with a suitable unit.
fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 10.0 => format!("{s:.1} s"),
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 0.1 => format!("{:.0} ms", 1e3 * s),
        s if s >= 0.001 => format!("{:.1} ms", 1e3 * s),
        s => format!("{:.0} us", 1e6 * s),
    }
}
