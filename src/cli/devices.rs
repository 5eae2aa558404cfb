//! `caustica devices`: what there is to render on.

use caustica::device;

use super::output::result;
use super::{Done, Failure};

/// List the devices, their drivers and limits, and what --device auto takes
#[derive(clap::Args)]
pub struct Arguments {}

/// Prints the list.
pub fn run(_: Arguments) -> Result<Done, Failure> {
    let devices = device::list();
    for device in &devices {
        result(format_args!("{} [{}] {}", device.name, device.kind.word(), device.driver))?;
        for (limit, value) in &device.limits {
            result(format_args!("    {limit:<32} {value}"))?;
        }
    }
    let (device, why) = device::pick(&device::Wanted::Auto, &devices)?;
    result(format_args!("--device auto takes {} ({why})", device.name))?;
    Ok(Done::Fully)
}
