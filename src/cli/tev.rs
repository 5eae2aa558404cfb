//! Sends the image to the viewer tev during a render.

use std::net::TcpStream;

use caustica::low_level::film::Picture;
use caustica::low_level::film::exr_file::Frame;
use caustica::low_level::film::tev::Tev;
use caustica::low_level::scene::Scene;
use miette::miette;

use super::Failure;
use super::output::message;

/// Connection to the viewer, `None` if there is none or it was lost.
pub struct Viewer(Option<Tev<TcpStream>>);

impl Viewer {
    /// Connects if an address is given. Fails if no viewer answers.
    pub fn connect(address: Option<&str>, scene: &Scene) -> Result<Self, Failure> {
        let Some(address) = address else {
            return Ok(Self(None));
        };
        let film = scene.film;
        let [x, y, ..] = film.window.unwrap_or_default();
        let frame = Frame { x, y, width: film.width, height: film.height };
        match Tev::connect(address, &scene.name, frame) {
            Ok(tev) => Ok(Self(Some(tev))),
            Err(error) => Err(Failure::failed(miette!(
                help = "start tev first, on this machine or with --host at the address, or drop \
                        --tev",
                "--tev: no viewer at {address}: {error}"
            ))),
        }
    }

    /// Sends the current image. On failure, prints a warning, disconnects, and lets the render
    /// continue.
    pub fn show(&mut self, picture: &Picture) {
        if let Some(error) = self.0.as_mut().and_then(|tev| tev.show(picture).err()) {
            message(format_args!("warning: connection to tev lost: {error}; the render continues"));
            self.0 = None;
        }
    }
}
