//! Failures of commands: messages and exit codes.

use std::process::ExitCode;

use caustica::low_level::checkpoint::CheckpointError;
use caustica::low_level::device::DeviceError;
use caustica::low_level::engine::EngineError;
use caustica::low_level::film::FileError;
use caustica::low_level::film::denoise::DenoiseError;
use caustica::low_level::film::metrics::MetricsError;
use caustica::low_level::gpu;
use caustica::low_level::render::Broken;
use caustica::low_level::scene::SceneErrors;
use caustica::low_level::study::StudyError;
use miette::{Report, miette};

use super::output::{paragraph, report};

/// Failure of a command.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    report: Report,
    /// Lines that follow the report, such as the log of a driver or compiler. They contain no file
    /// names.
    details: String,
}

impl Failure {
    const FAILED: u8 = 1;
    const WRONG_USE: u8 = 2;
    const NO_SUCH_DEVICE: u8 = 4;
    const DEVICE_FAILED: u8 = super::Done::DeviceLost as u8;

    /// Usage error, with a suggestion.
    pub fn wrong_use(what: &str, help: &str) -> Self {
        Self {
            code: Self::WRONG_USE,
            report: miette!(help = help.to_owned(), "{what}"),
            details: String::new(),
        }
    }

    /// Any other failure.
    pub fn failed(report: impl Into<Report>) -> Self {
        Self { code: Self::FAILED, report: report.into(), details: String::new() }
    }

    /// No suitable device exists.
    #[cfg(feature = "preview")]
    pub fn no_device(report: impl Into<Report>) -> Self {
        Self { code: Self::NO_SUCH_DEVICE, report: report.into(), details: String::new() }
    }

    /// The exit code.
    #[cfg(test)]
    pub fn code(&self) -> u8 {
        self.code
    }

    /// Prints the failure to standard error.
    pub fn tell(self) -> ExitCode {
        report(self.report.as_ref());
        if !self.details.is_empty() {
            paragraph(&self.details);
        }
        ExitCode::from(self.code)
    }
}

impl From<SceneErrors> for Failure {
    fn from(errors: SceneErrors) -> Self {
        Self::failed(errors)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        let code = match error {
            FileError::UnknownFormat { .. }
            | FileError::StreamName { .. }
            | FileError::Repeated { .. } => Self::WRONG_USE,
            _ => Self::FAILED,
        };
        Self { code, report: error.into(), details: String::new() }
    }
}

impl From<CheckpointError> for Failure {
    fn from(error: CheckpointError) -> Self {
        Self::failed(error)
    }
}

impl From<DenoiseError> for Failure {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::NotBuilt => Self::wrong_use(
                &format!("--denoise: {error}"),
                "install Open Image Denoise 2 (https://www.openimagedenoise.org), set OIDN_DIR to \
                 its folder, and build with `cargo build --release --features denoise`",
            ),
            _ => Self::failed(miette!("--denoise: {error}")),
        }
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        let code = if error.is_of_device() { Self::DEVICE_FAILED } else { Self::FAILED };
        let text = error.to_string();
        let (first, rest) = text.split_once('\n').unwrap_or((&text, ""));
        Self { code, report: miette!("{first}"), details: rest.trim_end().to_owned() }
    }
}

impl From<Broken> for Failure {
    fn from(broken: Broken) -> Self {
        broken.error.into()
    }
}

impl From<MetricsError> for Failure {
    fn from(error: MetricsError) -> Self {
        Self::failed(miette!("{error}"))
    }
}

impl From<DeviceError> for Failure {
    fn from(error: DeviceError) -> Self {
        match error {
            DeviceError::NoSuchDevice { ref available, .. } => {
                let help = match available.as_slice() {
                    [] => "no device was found".to_owned(),
                    names => {
                        format!(
                            "available: {}; run `caustica devices` for details",
                            names.join(", ")
                        )
                    }
                };
                let hidden = gpu::hidden().iter().map(|hidden| format!("note: {hidden}"));
                let details = hidden.collect::<Vec<_>>().join("\n");
                Self {
                    code: Self::NO_SUCH_DEVICE,
                    report: miette!(help = help, "{error}"),
                    details,
                }
            }
            DeviceError::Engine(error) => error.into(),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Device(error) => error.into(),
            StudyError::File(error) => error.into(),
            StudyError::Grid(_) | StudyError::Folder { .. } | StudyError::Variant { .. } => {
                Self { code: Self::WRONG_USE, report: miette!("{error}"), details: String::new() }
            }
            StudyError::Engine(error) => error.into(),
            StudyError::Metrics(_) => Self::failed(miette!("{error}")),
        }
    }
}
