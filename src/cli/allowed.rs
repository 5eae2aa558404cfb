//! Options that limit which files a scene may read, and their sizes.

use std::path::{Path, PathBuf};

use caustica::low_level::memory;
use caustica::low_level::scene::{self, Allowance, Loaded, Missing};
use clap::{Args, ValueEnum};

use super::Failure;

/// Options of all commands that read scenes.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Untrusted scenes")]
pub struct Allowed {
    /// Read files from this folder only, after resolving links; includes the scene file itself
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
    /// Override a limit, e.g. triangles=1e6: scene-bytes, shapes, mesh-bytes, mesh-triangles,
    /// triangles, texture-pixels, texture-bytes, picture-pixels or errors; repeatable
    #[arg(long, value_name = "NAME=N", value_parser = limit)]
    limit: Vec<(String, u64)>,
    /// Treat missing MTL and texture files as an error, or warn and use mid-gray
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    missing: OnMissing,
}

/// Handling of missing files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum OnMissing {
    #[default]
    Error,
    Warn,
}

impl From<OnMissing> for Missing {
    fn from(missing: OnMissing) -> Self {
        match missing {
            OnMissing::Error => Self::Error,
            OnMissing::Warn => Self::Warn,
        }
    }
}

impl Allowed {
    /// Converts the options to the library's type.
    pub fn allowance(&self) -> Result<Allowance, Failure> {
        if let Some(root) = self.root.as_ref().filter(|root| !root.is_dir()) {
            let what = format!("--root {}: the folder does not exist", root.display());
            return Err(Failure::wrong_use(
                &what,
                "give the folder that contains the scene and its files",
            ));
        }
        let (root, missing) = (self.root.clone(), self.missing.into());
        let allowance = Allowance { root, missing, ..Allowance::default() };
        // explicit limits override those derived from the available memory
        let mut allowance = match memory::limited() {
            Some((left, _)) => allowance.within_memory(left),
            None => allowance,
        };
        for (name, value) in &self.limit {
            if let Some(limit) = allowance.limit(name) {
                *limit = *value;
            }
        }
        Ok(allowance)
    }

    /// Reads a scene.
    pub fn load(&self, file: &Path) -> Result<Loaded, Failure> {
        Ok(scene::load_within(file, &self.allowance()?)?)
    }
}

fn limit(text: &str) -> Result<(String, u64), String> {
    let names = Allowance::LIMITS.join(", ");
    let (name, value) =
        text.split_once('=').ok_or("expected NAME=N, e.g. triangles=1e6".to_owned())?;
    if !Allowance::LIMITS.contains(&name) {
        return Err(format!("unknown limit {name}; the limits are {names}"));
    }
    let exact = value.parse::<u64>().ok();
    let rounded =
        || value.parse::<f64>().ok().filter(|n| (0.0..1e19).contains(n)).map(|n| n as u64);
    let value = exact
        .or_else(rounded)
        .ok_or(format!("`{value}` is not a number of zero or more, e.g. 1000000 or 1e6"))?;
    Ok((name.to_owned(), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_names_and_numbers() {
        assert_eq!(limit("triangles=1e6"), Ok(("triangles".to_owned(), 1_000_000)));
        assert_eq!(limit("errors=18446744073709551615"), Ok(("errors".to_owned(), u64::MAX)));
        for bad in [
            "",
            "triangles",
            "triangles=",
            "triangle=1",
            "shapes=-1",
            "shapes=nan",
            "shapes=1e20",
            "=1",
        ] {
            assert!(limit(bad).is_err(), "{bad}");
        }
        for name in Allowance::LIMITS {
            assert!(Allowance::default().limit(name).is_some(), "{name}");
        }
    }
}
