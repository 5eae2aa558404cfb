//! Adapters that the environment variables `WGPU_BACKEND` and `WGPU_ADAPTER_NAME` allow, and those
//! that they hide.

use std::fmt;
use std::sync::OnceLock;

use super::context::{AdapterKind, AdapterSummary, holds, summarize};

/// Environment variable that restricts the graphics interfaces.
const BACKEND: &str = "WGPU_BACKEND";
/// Environment variable that restricts the names of adapters.
const NAME: &str = "WGPU_ADAPTER_NAME";
/// Words of [`BACKEND`] in lower case, and the interface that each denotes.
const INTERFACES: [(&str, wgpu::Backends); 11] = [
    ("vulkan", wgpu::Backends::VULKAN),
    ("vk", wgpu::Backends::VULKAN),
    ("metal", wgpu::Backends::METAL),
    ("mtl", wgpu::Backends::METAL),
    ("dx12", wgpu::Backends::DX12),
    ("d3d12", wgpu::Backends::DX12),
    ("opengl", wgpu::Backends::GL),
    ("gles", wgpu::Backends::GL),
    ("gl", wgpu::Backends::GL),
    ("webgpu", wgpu::Backends::BROWSER_WEBGPU),
    ("noop", wgpu::Backends::NOOP),
];

/// Environment variable that hides adapters, or contains unknown words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hidden {
    /// Name of the variable.
    pub variable: &'static str,
    /// Value of the variable.
    pub value: String,
    /// Adapters that would be available without it.
    pub adapters: Vec<AdapterSummary>,
    /// Words in it that denote no graphics interface.
    pub unknown: Vec<String>,
}

impl fmt::Display for Hidden {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { variable, value, adapters, unknown } = self;
        write!(f, "{variable}={value}")?;
        if let Some(word) = unknown.first() {
            write!(f, " names no graphics interface by `{word}` (known: vulkan, metal, dx12)")?;
        }
        let names: Vec<&str> = adapters.iter().map(|adapter| adapter.name.as_str()).collect();
        match (names.as_slice(), unknown.as_slice()) {
            ([], []) => write!(f, " hides nothing"),
            ([], _) => write!(f, "; correct or unset {variable}"),
            (names, unknown) => {
                let and = if unknown.is_empty() { "" } else { " and" };
                write!(f, "{and} hides {}; unset {variable} to use it", names.join(", "))
            }
        }
    }
}

/// Values of both variables; `None` if a value is empty or not set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Filter {
    backend: Option<String>,
    name: Option<String>,
}

impl Filter {
    fn from_env() -> Self {
        let value = |name| {
            let value = std::env::var_os(name)?.to_string_lossy().trim().to_owned();
            (!value.is_empty()).then_some(value)
        };
        Self { backend: value(BACKEND), name: value(NAME) }
    }

    /// Graphics interfaces to search, and the words that denote none.
    fn backends(&self) -> (wgpu::Backends, Vec<String>) {
        let Some(list) = &self.backend else { return (wgpu::Backends::all(), Vec::new()) };
        let mut backends = wgpu::Backends::empty();
        let mut unknown = Vec::new();
        for word in list.split(',').map(str::trim) {
            match INTERFACES.iter().find(|(known, _)| word.eq_ignore_ascii_case(known)) {
                Some((_, backend)) => backends |= *backend,
                None => unknown.push(word.to_owned()),
            }
        }
        (backends, unknown)
    }

    fn takes(&self, summary: &AdapterSummary) -> bool {
        self.name.as_deref().is_none_or(|name| holds(&summary.name, name))
    }
}

/// Adapters found: those that may be used, and those excluded by their names.
struct Filtered {
    visible: Vec<(wgpu::Adapter, AdapterSummary)>,
    misnamed: Vec<AdapterSummary>,
}

/// Searches for adapters, once, since drivers take a while to respond.
fn found() -> &'static Filtered {
    static FOUND: OnceLock<Filtered> = OnceLock::new();
    FOUND.get_or_init(|| {
        let filter = Filter::from_env();
        let (visible, misnamed): (Vec<_>, Vec<_>) = of_backends(filter.backends().0)
            .into_iter()
            .partition(|(_, summary)| filter.takes(summary));
        Filtered { visible, misnamed: misnamed.into_iter().map(|(_, summary)| summary).collect() }
    })
}

/// Adapters of the given interfaces that the kernels can run on, hardware first.
fn of_backends(backends: wgpu::Backends) -> Vec<(wgpu::Adapter, AdapterSummary)> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends = backends;
    // no dispatch reads its size from a buffer, so wgpu need not compile a kernel that validates
    // such sizes
    descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    let instance = wgpu::Instance::new(descriptor);
    let mut list: Vec<_> = pollster::block_on(instance.enumerate_adapters(backends))
        .into_iter()
        .map(|adapter| {
            let summary = summarize(&adapter);
            (adapter, summary)
        })
        .filter(|(_, summary)| summary.fits())
        .collect();
    list.sort_by_key(|(_, summary)| summary.kind);
    list
}

/// Adapters that the kernels can run on, hardware first, restricted by `WGPU_BACKEND` and
/// `WGPU_ADAPTER_NAME`.
pub(super) fn adapters() -> &'static [(wgpu::Adapter, AdapterSummary)] {
    &found().visible
}

/// Variables that hide adapters or contain unknown words. Interfaces that `WGPU_BACKEND` excludes
/// are searched only if no hardware is left without them, since faulty drivers may be the reason
/// for the exclusion.
pub fn hidden() -> &'static [Hidden] {
    static HIDDEN: OnceLock<Vec<Hidden>> = OnceLock::new();
    HIDDEN.get_or_init(|| {
        let Filtered { visible, misnamed } = found();
        let filter = Filter::from_env();
        let hardware = |summary: &AdapterSummary| summary.kind != AdapterKind::Software;
        let left = visible.iter().map(|(_, summary)| summary).chain(misnamed).any(hardware);
        let excluded = match filter.backend {
            Some(_) if !left => of_backends(!filter.backends().0),
            _ => Vec::new(),
        };
        let excluded = excluded.into_iter().map(|(_, summary)| summary).collect();
        described(&filter, excluded, misnamed.clone())
    })
}

/// Describes the effect of each variable.
fn described(
    filter: &Filter,
    excluded: Vec<AdapterSummary>,
    misnamed: Vec<AdapterSummary>,
) -> Vec<Hidden> {
    let of = |variable, value: &Option<String>, adapters, unknown| {
        let value = value.clone()?;
        Some(Hidden { variable, value, adapters, unknown })
    };
    let backend = of(BACKEND, &filter.backend, excluded, filter.backends().1);
    let name = of(NAME, &filter.name, misnamed, Vec::new());
    let matters = |hidden: &Hidden| !(hidden.adapters.is_empty() && hidden.unknown.is_empty());
    backend.into_iter().chain(name).filter(matters).collect()
}

/// Theory: a variable that is empty or not set hides nothing; an unknown word, or an excluded
/// adapter, gives one line that names the variable, its value, what is hidden and the remedy.
#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str) -> AdapterSummary {
        AdapterSummary {
            name: name.to_owned(),
            kind: AdapterKind::Discrete,
            backend: "vulkan".to_owned(),
            driver: String::new(),
            binding_bytes: 0,
            buffer_bytes: 0,
            storage_buffers: 0,
            workgroup_invocations: 0,
        }
    }

    fn lines(
        backend: Option<&str>,
        name: Option<&str>,
        excluded: &[&str],
        misnamed: &[&str],
    ) -> Vec<String> {
        let filter = Filter { backend: backend.map(str::to_owned), name: name.map(str::to_owned) };
        let list = |names: &[&str]| names.iter().map(|name| adapter(name)).collect();
        described(&filter, list(excluded), list(misnamed)).iter().map(Hidden::to_string).collect()
    }

    #[test]
    fn each_variable_says_what_it_hides() {
        assert!(lines(None, None, &[], &[]).is_empty());
        assert!(lines(Some("vulkan, DX12"), Some("nv"), &[], &[]).is_empty());
        assert_eq!(
            lines(Some("gl"), Some("intel"), &["GeForce"], &["Radeon", "llvmpipe"]),
            [
                "WGPU_BACKEND=gl hides GeForce; unset WGPU_BACKEND to use it",
                "WGPU_ADAPTER_NAME=intel hides Radeon, llvmpipe; unset WGPU_ADAPTER_NAME to use it",
            ]
        );
        assert_eq!(
            lines(Some("vulcan"), None, &["GeForce"], &[]),
            [
                "WGPU_BACKEND=vulcan names no graphics interface by `vulcan` (known: vulkan, metal, dx12) and \
              hides GeForce; unset WGPU_BACKEND to use it"
            ]
        );
        assert_eq!(
            lines(Some("vk,vulcan"), None, &[], &[]),
            [
                "WGPU_BACKEND=vk,vulcan names no graphics interface by `vulcan` (known: vulkan, metal, dx12); \
              correct or unset WGPU_BACKEND"
            ]
        );
    }

    #[test]
    fn words_name_interfaces() {
        let backends =
            |text: &str| Filter { backend: Some(text.to_owned()), name: None }.backends();
        assert_eq!(
            backends("Vulkan , mtl"),
            (wgpu::Backends::VULKAN | wgpu::Backends::METAL, vec![])
        );
        assert_eq!(backends("x"), (wgpu::Backends::empty(), vec!["x".to_owned()]));
        assert_eq!(Filter::default().backends(), (wgpu::Backends::all(), vec![]));
    }
}
