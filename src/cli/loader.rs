//! Suppresses messages of Mesa's device-select layer.
//!
//! The Vulkan loader loads the layer into each program that enumerates devices. The layer connects
//! to Wayland, and libwayland complains about `XDG_RUNTIME_DIR` on standard error if there is no
//! desktop. `NODEVICE_SELECT` disables the layer if it is set when the loader starts. A program
//! cannot safely change its own environment, so it restarts itself with the variable set.

use caustica::low_level::device::{self, Wanted};

/// Variable that disables the layer.
#[cfg(target_os = "linux")]
const OFF: &str = "NODEVICE_SELECT";

/// Returns true if a `--device` value may select a device with a driver.
pub fn is_driver(device: &str) -> bool {
    !matches!(device::parse(device), Wanted::Cpu | Wanted::CpuDouble)
}

/// Restarts the program (exec) with the same arguments if the layer would complain. Does nothing on
/// a desktop, if the user selects a device with the layer's variables, or if exec fails.
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
    // exec returns only if it fails
    let error = command.args(arguments).env(OFF, "1").exec();
    log::debug!("the program cannot restart itself: {error}");
}

/// Does nothing: other systems have no such layer.
#[cfg(not(target_os = "linux"))]
pub fn quiet() {}
