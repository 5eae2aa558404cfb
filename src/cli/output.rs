//! Lines on standard output and standard error. A reader that went away, as in `caustica info scene.toml | head`, is no
//! failure; results that cannot be written for another reason are.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use super::Failure;

/// Prints a line of results to standard output.
pub fn result(line: impl Display) -> Result<(), Failure> {
    written(writeln!(io::stdout(), "{line}"))
}

/// Prints a whole text to standard output.
pub fn bytes(text: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout();
    written(out.write_all(text).and_then(|()| out.flush()))
}

fn written(outcome: io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::failed(miette::miette!("standard output cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line of anything else to standard error.
pub fn message(line: impl Display) {
    // There is nowhere to tell that standard error is gone.
    let _ = writeln!(io::stderr(), "{line}");
}
