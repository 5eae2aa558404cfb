//! Materials from MTL files. Only materials that faces use are read, and only the keys that their
//! kind uses; the rest causes warnings at most.

use std::ops::Range;
use std::path::Path;

use super::library::Library;
use super::lines::{Statement, Text, Word, finite, readings, statements};
use crate::scene::builder::SceneBuilder;
use crate::scene::diagnostics::{Faults, nearest};
use crate::scene::images::ImageFault;
use crate::scene::limits::Missing;
use crate::scene::numbers::{BRIGHTEST, LARGEST, Rounded, rounded_into};
use crate::scene::{Material, MaterialKind, Reflectance, Rgb, Texture, TextureKind};

/// Index of refraction of a transparent MTL material without `Ni`.
const DEFAULT_IOR: f64 = 1.5;
/// Diffuse reflectance of an MTL material without `Kd`.
const DEFAULT_DIFFUSE: [f64; 3] = [0.8; 3];

/// Keys that are read.
const READ: [&str; 7] = ["Kd", "Ks", "Ke", "Ni", "d", "illum", "map_Kd"];
/// Keys without a counterpart in a physically based renderer: ambient light, highlights, texture
/// antialiasing.
const IDLE: [&str; 4] = ["Ka", "map_Ka", "Ns", "map_aat"];
/// Keys that other programs read and that change the appearance of a surface.
const UNREAD: [&str; 28] = [
    "Tr",
    "Tf",
    "Pr",
    "Pm",
    "Ps",
    "Pc",
    "Pcr",
    "aniso",
    "anisor",
    "map_Ks",
    "map_Ns",
    "map_d",
    "map_Tr",
    "map_Ke",
    "map_Bump",
    "map_bump",
    "bump",
    "norm",
    "map_Pr",
    "map_Pm",
    "map_Ps",
    "map_Pc",
    "map_norm",
    "refl",
    "map_refl",
    "disp",
    "decal",
    "sharpness",
];

/// Converts an MTL material to a scene material called `name`, and returns its emission, from `Ke`
/// if `emits` is true. Adds the texture of `map_Kd` to the scene. The material is glass if `illum`
/// is 4, 6, 7 or 9, or if `d` is below 1 and `Ni` is given and not 1; a mirror of `Ks` if `illum`
/// is 3 or 5; else diffuse with `map_Kd` or, without one, `Kd`.
pub(super) fn material(
    library: &mut Library,
    entry: usize,
    name: String,
    emits: bool,
    builder: &mut SceneBuilder,
) -> (Material, Rgb) {
    let Library { path, text, entries, faults, warnings, rounded } = library;
    let lines = text.lines();
    let mut given: Vec<Statement> = Vec::new();
    for statement in statements(lines, entries[entry].body.clone()) {
        // The last of several statements of a key counts. Only known keys are compared, so that
        // their number bounds the work.
        let known = READ.contains(&statement.keyword) || IDLE.contains(&statement.keyword);
        if known && let Some(last) = given.iter_mut().find(|last| last.keyword == statement.keyword)
        {
            *last = statement;
        } else if given.len() < MOST_KEYS {
            given.push(statement);
        }
    }
    let mut reader =
        Reader { name: &name, given: &given, used: Vec::new(), faults, warnings, rounded };
    let emission = if emits { reader.color("Ke", BRIGHTEST) } else { None };
    let kind = reader.kind(path, text, builder);
    reader.unused(matches!(kind, MaterialKind::Glass { .. }));
    (Material { name, ..Material::new(kind) }, emission.unwrap_or([0.0; 3]))
}

/// Most statements of a material that are examined.
const MOST_KEYS: usize = 1000;

struct Reader<'l, 't> {
    name: &'l str,
    given: &'l [Statement<'t>],
    /// Keys whose values are used.
    used: Vec<&'static str>,
    faults: &'l mut Faults,
    warnings: &'l mut Faults,
    rounded: &'l mut Rounded,
}

impl<'t> Reader<'_, 't> {
    fn kind(&mut self, path: &Path, text: &Text, builder: &mut SceneBuilder) -> MaterialKind {
        let illum = self.illum();
        let is_glass = matches!(illum, Some(4 | 6 | 7 | 9));
        let is_clear = !is_glass && self.number("d", 1.0).is_some_and(|d| d < 1.0);
        let ior = (is_glass || is_clear).then(|| self.number("Ni", LARGEST)).flatten();
        let ior = ior.filter(|&ior| ior > 0.0);
        if is_glass || (is_clear && ior.is_some_and(|ior| ior != 1.0)) {
            MaterialKind::Glass {
                ior: ior.unwrap_or(DEFAULT_IOR),
                roughness: 0.0,
                absorption: [0.0; 3],
                priority: 0,
            }
        } else {
            if is_clear {
                self.warn_unused("d");
            }
            if matches!(illum, Some(3 | 5)) {
                let color = self.color("Ks", 1.0).or_else(|| self.color("Kd", 1.0));
                MaterialKind::Mirror { reflectance: Reflectance::Color(color.unwrap_or([1.0; 3])) }
            } else {
                let reflectance = match self.find("map_Kd") {
                    Some(map) => self.map(&map, path, text, builder),
                    None => Reflectance::Color(self.color("Kd", 1.0).unwrap_or(DEFAULT_DIFFUSE)),
                };
                MaterialKind::Diffuse { reflectance, roughness: 0.0 }
            }
        }
    }

    fn find(&self, key: &str) -> Option<Statement<'t>> {
        self.given.iter().find(|statement| statement.keyword == key).cloned()
    }

    fn color(&mut self, key: &'static str, most: f64) -> Option<Rgb> {
        let numbers = self.numbers(key, 3, most)?;
        Some([numbers[0], numbers[1], numbers[2]])
    }

    fn number(&mut self, key: &'static str, most: f64) -> Option<f64> {
        self.numbers(key, 1, most)?.first().copied()
    }

    /// Reads `count` values of a key, each from 0 to `most`; reports invalid ones.
    fn numbers(&mut self, key: &'static str, count: usize, most: f64) -> Option<Vec<f64>> {
        let statement = self.find(key)?;
        self.used.push(key);
        let words = values(&statement);
        if words.len() < count {
            let message = format!("`{key}` has {} values", words.len());
            self.faults.push(statement.at, message, expected(count));
            return None;
        }
        if let Some((_, at)) = words.get(count) {
            let message = format!(
                "`{key}` has {} values, of which only the first {count} count",
                words.len()
            );
            self.warnings.push(at.clone(), message, expected(count));
        }
        let mut numbers = Vec::new();
        for (word, at) in &words[..count] {
            match in_range(word, most) {
                Ok(number) => {
                    if finite(word) != Ok(number) {
                        self.rounded.add(at.clone(), word, number);
                    }
                    numbers.push(number);
                }
                Err(message) => {
                    let expected = format!("expected a number from 0 to {most:e}");
                    self.faults.push(at.clone(), message, expected);
                }
            }
        }
        (numbers.len() == count).then_some(numbers)
    }

    /// The illumination model: an integer in any notation.
    fn illum(&mut self) -> Option<i64> {
        let statement = self.find("illum")?;
        self.used.push("illum");
        let Some((word, at)) = statement.words().next() else {
            self.faults.push(statement.at, "`illum` has no value", "expected a whole number");
            return None;
        };
        match finite(word) {
            Ok(number) if number.fract() == 0.0 && number.abs() < 1e9 => {
                if !(0.0..=10.0).contains(&number) {
                    let message = format!("`illum` {word} of material {} is not known", self.name);
                    self.warnings.push(at, message, "expected 0 to 10; read as diffuse");
                }
                Some(number as i64)
            }
            Ok(_) => {
                self.faults.push(
                    at,
                    format!("`{word}` is not a whole number"),
                    "expected a whole number",
                );
                None
            }
            Err(message) => {
                self.faults.push(at, message, "expected a whole number");
                None
            }
        }
    }

    /// Reflectance from the image of `map_Kd`.
    fn map(
        &mut self,
        map: &Statement,
        path: &Path,
        text: &Text,
        builder: &mut SceneBuilder,
    ) -> Reflectance {
        let grey = Reflectance::Color([Missing::STAND_IN; 3]);
        self.used.push("map_Kd");
        let (name, at) = map.name();
        if name.is_empty() {
            self.faults.push(map.at.clone(), "`map_Kd` names no file", "expected a file name");
            return grey;
        }
        if name.starts_with('-') {
            self.faults.push(at, "options of `map_Kd` are not supported", "expected a file name");
            return grey;
        }
        let folder = path.parent().unwrap_or("".as_ref());
        let mut files = readings(name).map(|name| text.find(builder.allowance, folder, name));
        let first = files.next().unwrap_or_default();
        let all = || std::iter::once(first.clone()).chain(files);
        let file = all().find(|file| builder.allowance.has(file)).unwrap_or(first.clone());
        let image = builder.images.load(&file, None, None).and_then(|image| {
            builder.images.bound_by_one(&file, image)?;
            Ok(image)
        });
        match image {
            Ok(image) => {
                if builder.images.is_transparent(image) {
                    let message = format!(
                        "the alpha channel of map_Kd of material {} is not used",
                        self.name
                    );
                    self.warnings.push(at.clone(), message, "every texel counts as opaque");
                }
                for (message, label) in builder.images.take_notes(image) {
                    self.warnings.push(at.clone(), message, label);
                }
                let (filter, wrap) = Default::default();
                let kind = TextureKind::Image { image, filter, wrap, scale: [1.0; 2] };
                let texture = Texture { name: self.name.to_owned(), kind };
                Reflectance::Texture(builder.add_own_texture(texture))
            }
            Err(ImageFault { missing: true, message, .. })
                if builder.allowance.missing == Missing::Warn =>
            {
                self.warnings.push(at, message, "rendered in gray");
                grey
            }
            Err(fault) => {
                let expected = fault.help.unwrap_or_else(|| fault.expected.to_owned());
                let advice = if fault.missing {
                    format!("{expected}, {}", Missing::ADVICE)
                } else {
                    expected
                };
                self.faults.push(at, fault.message, advice);
                grey
            }
        }
    }

    fn warn_unused(&mut self, key: &str) {
        if let Some(statement) = self.find(key) {
            let message = format!("`{key}` of material {} is not used", self.name);
            self.warnings.push(statement.at, message, "has no effect");
        }
    }

    /// Warns about unused statements that other programs show, that have invalid values, or whose
    /// key is unknown.
    fn unused(&mut self, is_glass: bool) {
        for statement in self.given {
            let (key, at) = (statement.keyword, statement.at.clone());
            if self.used.contains(&key) {
                continue;
            }
            if READ.contains(&key) || IDLE.contains(&key) {
                if key == "map_Kd" {
                    let message = format!("`{key}` of material {} is not used", self.name);
                    self.warnings.push(at, message, "mirrors and glass have no texture");
                } else if let Some((at, message)) = wrong(statement) {
                    self.warnings.push(at, message + ", and is not used", "has no effect");
                }
            } else if UNREAD.contains(&key) {
                let is_glass_already = is_glass && matches!(key, "Tr" | "map_d" | "map_Tr");
                if !is_neutral(statement) && !is_glass_already {
                    let message = format!("`{key}` of material {} is not used", self.name);
                    self.warnings.push(at, message, "has no effect");
                }
            } else {
                let message = format!("`{key}` of material {} is not known", self.name);
                let near = READ.iter().find(|known| known.eq_ignore_ascii_case(key)).copied();
                let near = near.or_else(|| nearest(key, READ));
                let label =
                    near.map_or("not used".to_owned(), |near| format!("did you mean `{near}`?"));
                self.warnings.push(at, message, label);
            }
        }
    }
}

/// Arguments that should be numbers.
fn values<'t>(statement: &Statement<'t>) -> Vec<Word<'t>> {
    let is_option = |word: &str| statement.keyword == "d" && word == "-halo";
    statement.words().filter(|(word, _)| !is_option(word)).collect()
}

fn expected(count: usize) -> String {
    format!("expected {count} number{}", if count == 1 { "" } else { "s" })
}

/// Parses a number from 0 to `most`, which it may exceed by rounding.
fn in_range(word: &str, most: f64) -> Result<f64, String> {
    let number = finite(word)?;
    rounded_into(number, 0.0, most).ok_or_else(|| format!("`{word}` is out of range"))
}

/// The error in the values of a known key, if there is one.
fn wrong(statement: &Statement) -> Option<(Range<usize>, String)> {
    let (count, most) = match statement.keyword {
        "Kd" | "Ks" => (3, 1.0),
        "Ka" | "Ke" => (3, BRIGHTEST),
        "Ni" | "Ns" => (1, LARGEST),
        "d" => (1, 1.0),
        _ => return None,
    };
    let words = values(statement);
    if words.len() < count {
        let plural = if words.len() == 1 { "" } else { "s" };
        return Some((
            statement.at.clone(),
            format!("`{}` has {} value{plural}", statement.keyword, words.len()),
        ));
    }
    words.into_iter().take(count).find_map(|(word, at)| Some((at, in_range(word, most).err()?)))
}

/// Returns whether an unsupported key has a value without effect.
fn is_neutral(statement: &Statement) -> bool {
    let neutral = match statement.keyword {
        "Tr" | "Pm" | "Ps" | "Pc" | "Pcr" | "aniso" | "anisor" => 0.0,
        "Tf" => 1.0,
        _ => return false,
    };
    statement.words().all(|(word, _)| finite(word) == Ok(neutral))
}
