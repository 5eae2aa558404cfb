//! `caustica devices`: list of devices.

use caustica::low_level::device::{self, DeviceInfo};
use caustica::low_level::gpu::{self, Hidden};
use serde_json::{Value, json};

use super::output::result;
use super::{Done, Failure, hidden};

/// List the devices with drivers and limits, and the choice of --device auto
#[derive(clap::Args)]
pub struct Arguments {
    /// Print the list as a JSON object
    #[arg(long)]
    json: bool,
}

/// Prints the list.
pub fn run(arguments: Arguments) -> Result<Done, Failure> {
    let devices = device::list();
    let hidden = gpu::hidden();
    hidden.iter().for_each(hidden::tell);
    let (auto, why) = device::pick(&device::Wanted::Auto, &devices)?;
    if arguments.json {
        let each = devices.iter().map(|DeviceInfo { name, kind, driver, limits }| {
            let limits = Value::from_iter(limits.iter().cloned());
            json!({ "name": name, "kind": kind.word(), "driver": driver, "limits": limits })
        });
        let each: Vec<_> = each.collect();
        let hidden = hidden.iter().map(|Hidden { variable, value, adapters, unknown: _ }| {
            let names: Vec<_> = adapters.iter().map(|adapter| adapter.name.as_str()).collect();
            json!({ "variable": variable, "value": value, "devices": names })
        });
        result(json!({
            "event": "devices",
            "devices": each,
            "auto": auto.name,
            "why": why,
            "hidden": hidden.collect::<Vec<_>>(),
        }))?;
        return Ok(Done::Fully);
    }
    for device in &devices {
        result(format_args!("{} [{}] {}", device.name, device.kind.word(), device.driver))?;
        for (limit, value) in &device.limits {
            result(format_args!("    {limit:<32} {value}"))?;
        }
    }
    result(format_args!("--device auto selects {} ({why})", auto.name))?;
    Ok(Done::Fully)
}
