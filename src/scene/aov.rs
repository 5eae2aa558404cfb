//! Arbitrary output variables (AOVs): image channels in addition to radiance, for denoising and
//! compositing.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A group of output channels in addition to R, G and B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Aov {
    /// Reflectance at the first hit that is neither mirror nor glass, times the throughput of the
    /// mirrors and glass before it.
    Albedo,
    /// World-space shading normal at that hit, facing the viewer.
    Normal,
    /// Distance of the first hit along the view direction, in scene units.
    Depth,
    /// World-space position of the first hit.
    Position,
    /// Index of the surface at the pixel centre, counted from 1 in file order.
    Object,
    /// Index of that surface's material, counted from 1 in name order; the file attribute
    /// `caustica.materials` lists the names.
    Material,
    /// Light that reaches the eye directly or through mirrors and glass only.
    Emission,
    /// Direct lighting at the first hit that is neither mirror nor glass, from shadow rays.
    Direct,
    /// Light from photons that no diffuse surface has scattered: caustics, and also direct lighting
    /// where there are no shadow rays.
    Caustic,
    /// Light from photons that a diffuse surface has scattered.
    Indirect,
    /// Gather radius, in scene units.
    Radius,
    /// Photons gathered in the last pass.
    Photons,
    /// Variance and bias of the luminance, which files include anyway from pass 4 on.
    Variance,
}

impl Aov {
    /// All variants, in declaration order.
    pub const ALL: [Self; 13] = [
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Position,
        Self::Object,
        Self::Material,
        Self::Emission,
        Self::Direct,
        Self::Caustic,
        Self::Indirect,
        Self::Radius,
        Self::Photons,
        Self::Variance,
    ];

    /// Name in scene files and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Object => "object",
            Self::Material => "material",
            Self::Emission => "emission",
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
            Self::Radius => "radius",
            Self::Photons => "photons",
            Self::Variance => "variance",
        }
    }

    /// Returns whether it requires the kernel `aov_trace`.
    pub fn is_traced(self) -> bool {
        !matches!(self, Self::Caustic | Self::Indirect | Self::Photons | Self::Variance)
    }
}

/// A set of [`Aov`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Aovs(u32);

impl Aovs {
    /// Returns whether the set contains `aov`.
    pub fn has(self, aov: Aov) -> bool {
        self.0 >> aov as u32 & 1 == 1
    }

    /// Returns whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Union of two sets.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Members, in the order of [`Aov::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Aov> {
        Aov::ALL.into_iter().filter(move |aov| self.has(*aov))
    }

    /// Returns whether any member requires the kernel `aov_trace`.
    pub fn are_traced(self) -> bool {
        self.iter().any(Aov::is_traced)
    }

    /// Parses comma-separated names, or `all`.
    ///
    /// # Errors
    /// An unknown name; the message suggests the nearest name or lists all of them.
    pub fn parse(text: &str) -> Result<Self, String> {
        let of_word = |word: &str| match word {
            "all" => Ok(Aov::ALL.into_iter().collect()),
            _ => Aov::ALL
                .into_iter()
                .find(|aov| aov.word() == word)
                .map(|aov| Self(1 << aov as u32))
                .ok_or_else(|| match nearest(word) {
                    Some(near) => format!("unknown channel `{word}`; did you mean `{near}`?"),
                    None => {
                        format!("unknown channel `{word}`; expected {} or all", words().join(", "))
                    }
                }),
        };
        text.split(',')
            .map(|word| of_word(word.trim()))
            .try_fold(Self::default(), |set, one| Ok(set.union(one?)))
    }
}

impl FromIterator<Aov> for Aovs {
    fn from_iter<T: IntoIterator<Item = Aov>>(aovs: T) -> Self {
        Self(aovs.into_iter().fold(0, |set, aov| set | 1 << aov as u32))
    }
}

/// Comma-separated names, in the format that [`Aovs::parse`] reads.
impl std::fmt::Display for Aovs {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.iter().map(Aov::word).collect::<Vec<_>>().join(","))
    }
}

impl From<Aovs> for String {
    fn from(aovs: Aovs) -> Self {
        aovs.to_string()
    }
}

impl TryFrom<String> for Aovs {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if text.is_empty() { Ok(Self::default()) } else { Self::parse(&text) }
    }
}

fn words() -> [&'static str; 13] {
    Aov::ALL.map(Aov::word)
}

/// The known name nearest to `word`, if the edit distance is small enough for a typo.
fn nearest(word: &str) -> Option<&'static str> {
    let distance = |known: &&str| strsim::damerau_levenshtein(word, known);
    words()
        .into_iter()
        .chain(["all"])
        .min_by_key(distance)
        .filter(|near| distance(near) <= 1 + word.len() / 4)
}

/// Theory: parsing a printed set returns the same set.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_read_back_as_printed() {
        for bits in 1..1 << Aov::ALL.len() {
            assert_eq!(Aovs::parse(&Aovs(bits).to_string()), Ok(Aovs(bits)));
        }
        let none = serde_json::json!(Aovs::default());
        assert_eq!(serde_json::from_value::<Aovs>(none).unwrap(), Aovs::default());
        assert_eq!(Aovs::parse("all").unwrap().iter().count(), Aov::ALL.len());
        assert_eq!(Aovs::parse(" depth, albedo").unwrap().to_string(), "albedo,depth");
    }

    #[test]
    fn slips_are_named() {
        assert_eq!(
            Aovs::parse("albedo,nornal").unwrap_err(),
            "unknown channel `nornal`; did you mean `normal`?"
        );
        for far in ["", "albedo,", "cryptomatte"] {
            assert!(Aovs::parse(far).unwrap_err().contains("expected albedo, normal"), "{far}");
        }
    }

    /// Theory: scene files and [`Aov::word`] use the same names.
    #[test]
    fn words_are_those_of_scene_files() {
        for aov in Aov::ALL {
            assert_eq!(serde_json::json!(aov), aov.word());
        }
    }
}
