//! Composition of a kernel's shader from the files that it needs and the declarations of its
//! bindings, and mapping of naga's line numbers back to files.

use super::dispatch;
use super::fragments::{Fragment, Names, fragments, preprocess};
use super::layout::{SceneLayout, bindings, declarations};
use crate::materials::Bsdf;
use crate::plan::Kernel;
use crate::plan::features::{Feature, Features};
use std::collections::BTreeSet;

/// Path that errors in the generated declarations are reported under.
pub const DECLARATIONS: &str = "(declarations)";

/// Error in a shader.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}: {message}")]
pub struct ShaderError {
    /// Path below `shaders/`, or [`DECLARATIONS`].
    pub file: &'static str,
    /// Line in that file, from 1.
    pub line: u32,
    /// Description of the error.
    pub message: String,
}

/// Shader of one kernel.
#[derive(Clone, Debug)]
pub struct Shader {
    /// WGSL source.
    pub source: String,
    /// Path of each part, and its first line within `source`, from 1.
    parts: Vec<(&'static str, u32)>,
}

/// Functions that several materials share, and these materials.
const SHARED_CODE: [(&str, &[Bsdf]); 2] = [
    (
        "fresnel",
        &[
            Bsdf::Metal,
            Bsdf::Conductor,
            Bsdf::Brushed,
            Bsdf::Coat,
            Bsdf::PlasticBase,
            Bsdf::SmoothMetal,
            Bsdf::Glass,
            Bsdf::RoughGlass,
            Bsdf::RoughPane,
            Bsdf::ThinGlass,
            Bsdf::Clearcoat,
        ],
    ),
    (
        "microfacet",
        &[
            Bsdf::Metal,
            Bsdf::Conductor,
            Bsdf::Brushed,
            Bsdf::Coat,
            Bsdf::PlasticBase,
            Bsdf::RoughGlass,
            Bsdf::RoughPane,
        ],
    ),
];

/// Names that fences may use for `kernel`: the features, all kernels' stems, `scene` (the kernel
/// reads the packed scene), `area` (some light is a shape), `fresnel` and `microfacet` (some
/// material uses those functions).
pub fn names(kernel: Kernel, features: &Features) -> Names {
    let stems = Kernel::ALL.map(Kernel::stem);
    let known = Feature::all()
        .map(Feature::name)
        .chain(stems)
        .chain(["scene", "area"])
        .chain(SHARED_CODE.map(|(name, _)| name));
    let mut held: BTreeSet<&'static str> = features.iter().map(Feature::name).collect();
    held.insert(kernel.stem());
    if kernel.info().traces {
        held.insert("scene");
    }
    if features.iter().any(|feature| feature.name().starts_with("area_")) {
        held.insert("area");
    }
    for (name, users) in SHARED_CODE {
        if users.iter().any(|bsdf| features.has(Feature::Material(*bsdf))) {
            held.insert(name);
        }
    }
    Names { known: known.collect(), held }
}

/// Composes the shader of `kernel` for a scene that needs `features` and has the tables `scene`.
pub fn compose(
    kernel: Kernel,
    features: &Features,
    scene: &SceneLayout,
) -> Result<Shader, ShaderError> {
    compose_from(&fragments(), kernel, features, scene)
}

/// [`compose`] with the given shader files.
pub fn compose_from(
    fragments: &[Fragment],
    kernel: Kernel,
    features: &Features,
    scene: &SceneLayout,
) -> Result<Shader, ShaderError> {
    let names = names(kernel, features);
    let mut shader = Shader { source: String::new(), parts: Vec::new() };
    let mut declared = declarations(&bindings(kernel, *features));
    if kernel.info().traces {
        declared.insert_str(0, &scene.declaration());
    } else if kernel == Kernel::Gather && features.has(Feature::LobeParameters) {
        declared.insert_str(0, &scene.declaration_of(&["materials"]));
    }
    declared.push_str(&dispatch::dispatch(kernel, *features));
    shader.push(DECLARATIONS, &declared);
    for fragment in fragments {
        let fault = |line, message| ShaderError { file: fragment.path, line, message };
        if names.holds(fragment.condition).map_err(|message| fault(0, message))? {
            let text = preprocess(fragment.text, &names)
                .map_err(|(line, message)| fault(line, message))?;
            shader.push(fragment.path, &text);
        }
    }
    Ok(shader)
}

impl Shader {
    fn push(&mut self, path: &'static str, text: &str) {
        self.parts.push((path, self.source.matches('\n').count() as u32 + 1));
        self.source.push_str(text);
    }

    /// Maps a line of `source` to its file and the line in it, both from 1.
    pub fn locate(&self, line: u32) -> (&'static str, u32) {
        let part = self.parts.iter().rev().find(|(_, first)| *first <= line);
        part.map_or((DECLARATIONS, line), |(path, first)| (path, line - first + 1))
    }

    /// Parses and validates the shader with naga.
    pub fn validate(&self) -> Result<(naga::Module, naga::valid::ModuleInfo), ShaderError> {
        let at = |location: Option<naga::SourceLocation>, message: String| {
            let (file, line) = self.locate(location.map_or(1, |l| l.line_number));
            ShaderError { file, line, message }
        };
        let module = naga::front::wgsl::parse_str(&self.source)
            .map_err(|e| at(e.location(&self.source), e.message().to_string()))?;
        let flags = naga::valid::ValidationFlags::all();
        let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
            .validate(&module)
            // the last span is the innermost
            .map_err(|e| {
                let location = e.spans().last().map(|(span, _)| span.location(&self.source));
                at(location, causes(e.as_inner()))
            })?;
        Ok((module, info))
    }
}

/// Formats an error and its causes on one line.
pub fn causes(error: &dyn std::error::Error) -> String {
    let chain = std::iter::successors(error.source(), |e| e.source());
    chain.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}
