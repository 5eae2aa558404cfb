//! The software Vulkan driver that tests on a device run on.

use caustica::low_level::gpu::{AdapterChoice, AdapterKind, list};

/// Asks for the software driver; fails loudly where there is none.
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
