//! The software Vulkan driver for tests on a device.

use caustica::low_level::gpu::{AdapterChoice, AdapterKind, list};

/// Selects the software driver; fails with instructions if there is none.
pub fn software() -> AdapterChoice {
    let adapters = list();
    let Some(adapter) = adapters.iter().find(|a| a.kind == AdapterKind::Software) else {
        panic!(
            "no software Vulkan driver: install lavapipe (Debian and Ubuntu: apt install mesa-vulkan-drivers; Fedora: \
             dnf install mesa-vulkan-drivers). Adapters found: {adapters:?}"
        );
    };
    println!("on {} ({}, {})", adapter.name, adapter.backend, adapter.driver);
    AdapterChoice::Software
}
