//! Client for the image viewer tev (<https://github.com/Tom94/tev>) and its TCP protocol.
//!
//! A packet consists of its length in bytes as u32 (including these four bytes), a type byte and
//! fields. All numbers are little-endian, strings are zero-terminated. Two types are used:
//! CreateImage (4) and version 3 of UpdateImage (6), which sends values of several channels with an
//! offset and a stride for each.

use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use super::Picture;
use super::exr_file::Frame;

/// Default address on which tev listens.
pub const ADDRESS: &str = "127.0.0.1:14158";

const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE: u8 = 6;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Timeout for connecting and for each write.
const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum number of values in a packet. A packet always has at least one row.
const PACKET_VALUES: usize = 1 << 20;

/// A connection to a running tev that displays one image.
#[derive(Debug)]
pub struct Tev<W: Write> {
    stream: W,
    name: String,
    frame: Frame,
}

impl Tev<TcpStream> {
    /// Connects to `host:port` and creates an image of the given name.
    ///
    /// # Errors
    /// If no connection is established within a few seconds, or a write fails or times out.
    pub fn connect(address: &str, name: &str, frame: Frame) -> io::Result<Self> {
        let mut failure =
            io::Error::new(io::ErrorKind::AddrNotAvailable, "the host name has no address");
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(stream) => {
                    stream.set_write_timeout(Some(PATIENCE))?;
                    return Self::open(stream, name, frame);
                }
                Err(error) => failure = error,
            }
        }
        Err(failure)
    }
}

impl<W: Write> Tev<W> {
    /// Creates an image in tev. It replaces an existing image of the same name.
    pub fn open(mut stream: W, name: &str, frame: Frame) -> io::Result<Self> {
        let mut packet = Packet::new(CREATE_IMAGE, name);
        packet.ints(&[frame.width, frame.height, CHANNELS.len() as u32]);
        CHANNELS.iter().for_each(|channel| packet.text(channel));
        stream.write_all(&packet.finished()?)?;
        stream.flush()?;
        Ok(Self { stream, name: name.to_owned(), frame })
    }

    /// Sends the pixels of an image to its position in the frame.
    pub fn show(&mut self, picture: &Picture) -> io::Result<()> {
        let row = picture.width as usize;
        let rows = (PACKET_VALUES / (CHANNELS.len() * row).max(1)).max(1);
        for (number, part) in picture.rgb.chunks(rows * row.max(1)).enumerate() {
            let y = self.frame.y + (number * rows) as u32;
            let mut packet = Packet::new(UPDATE_IMAGE, &self.name);
            packet.ints(&[CHANNELS.len() as u32]);
            CHANNELS.iter().for_each(|channel| packet.text(channel));
            packet.ints(&[self.frame.x, y, picture.width, (part.len() / row.max(1)) as u32]);
            for offset in 0..CHANNELS.len() as i64 {
                packet.bytes(&offset.to_le_bytes());
            }
            for _ in CHANNELS {
                packet.bytes(&(CHANNELS.len() as i64).to_le_bytes());
            }
            part.as_flattened().iter().for_each(|value| packet.bytes(&value.to_le_bytes()));
            self.stream.write_all(&packet.finished()?)?;
        }
        self.stream.flush()
    }
}

struct Packet(Vec<u8>);

impl Packet {
    /// Starts a packet for the image of this name. Only a new image takes the focus, so that
    /// updates do not interrupt a user who looks at another image.
    fn new(kind: u8, name: &str) -> Self {
        let mut packet = Self(vec![0; 4]);
        packet.bytes(&[kind, u8::from(kind == CREATE_IMAGE)]);
        packet.text(name);
        packet
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn ints(&mut self, numbers: &[u32]) {
        numbers.iter().for_each(|number| self.bytes(&number.to_le_bytes()));
    }

    fn text(&mut self, text: &str) {
        self.0.extend(text.bytes().filter(|byte| *byte != 0));
        self.0.push(0);
    }

    fn finished(mut self) -> io::Result<Vec<u8>> {
        let length = u32::try_from(self.0.len()).map_err(io::Error::other)?;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        Ok(self.0)
    }
}
