//! The picture, sent to a running tev while it is rendered.

use std::net::TcpStream;

use caustica::low_level::film::Picture;
use caustica::low_level::film::exr_file::Frame;
use caustica::low_level::film::tev::Tev;
use caustica::low_level::scene::Scene;
use miette::miette;

use super::Failure;
use super::output::message;

/// A viewer, until it is gone.
pub struct Viewer(Option<Tev<TcpStream>>);

impl Viewer {
    /// Connects where an address is given; fails where nothing answers.
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
                help = "start tev first, on this machine or with --host at the address, or leave --tev out",
                "--tev: no viewer takes a picture at {address}: {error}"
            ))),
        }
    }

    /// Sends the picture so far. A viewer that does not take it is told once and left alone: the
    /// render goes on.
    pub fn show(&mut self, picture: &Picture) {
        if let Some(error) = self.0.as_mut().and_then(|tev| tev.show(picture).err()) {
            message(format_args!(
                "warning: tev takes no more pictures: {error}; the render goes on"
            ));
            self.0 = None;
        }
    }
}
