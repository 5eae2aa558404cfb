//! Warnings about environment variables that hide devices.

use caustica::low_level::device::{self, DeviceKind, Wanted};
use caustica::low_level::gpu::{self, Hidden};

use super::output::message;

/// Warns about variables that affected the choice of a device, if `auto` found no hardware GPU or a
/// variable contains unknown words. If no device fits, the failure lists the hidden ones instead.
pub fn warn(wanted: &Wanted) {
    if matches!(wanted, Wanted::Cpu | Wanted::CpuDouble) {
        return;
    }
    let auto = *wanted == Wanted::Auto
        && device::list().iter().all(|device| device.kind != DeviceKind::Gpu);
    gpu::hidden().iter().filter(|hidden| auto || !hidden.unknown.is_empty()).for_each(tell);
}

/// Prints the warning.
pub fn tell(hidden: &Hidden) {
    message(format_args!("warning: {hidden}"));
}
