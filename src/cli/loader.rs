//! Keeps Mesa's device-select layer quiet.
//!
//! The Vulkan loader runs the layer in each program that looks for devices. It asks Wayland for a
//! display, and libwayland complains about `XDG_RUNTIME_DIR` on standard error where there is no
//! desktop. The layer stays away if `NODEVICE_SELECT` is set when the loader starts. A program
//! cannot safely change its own environment, so it starts itself once more with the variable.

use caustica::low_level::device::{self, Wanted};

/// The variable that keeps the layer away.
#[cfg(target_os = "linux")]
const OFF: &str = "NODEVICE_SELECT";

/// Whether a `--device` value means a device with a driver.
pub fn is_driver(device: &str) -> bool {
    !matches!(device::parse(device), Wanted::Cpu | Wanted::CpuDouble)
}

/// Starts the program again, in the same process and with the same arguments, if the layer would
/// complain. On a desktop, and where the user chooses a device by the layer's own variables, it
/// stays as it is. Does nothing if the system refuses.
#[cfg(target_os = "linux")]
pub fn quiet() {
    use std::env;
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::Command;

    let set = |name| env::var_os(name).is_some();
    let runtime = env::var_os("XDG_RUNTIME_DIR");
    let complains = runtime.is_none_or(|folder| !Path::new(&folder).is_absolute());
    if !complains || set(OFF) || set("MESA_VK_DEVICE_SELECT") || set("DRI_PRIME") {
        return;
    }
    let Ok(program) = env::current_exe() else { return };
    let mut arguments = env::args_os();
    let mut command = Command::new(program);
    if let Some(name) = arguments.next() {
        command.arg0(name);
    }
    // returns only if it fails
    let error = command.args(arguments).env(OFF, "1").exec();
    log::debug!("the program does not start again: {error}");
}

/// Other systems have no such layer.
#[cfg(not(target_os = "linux"))]
pub fn quiet() {}
