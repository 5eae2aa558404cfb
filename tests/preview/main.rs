//! The preview: its worker and session without a window, and the window under Xvfb.
#![cfg(feature = "preview")]

#[path = "../support/mod.rs"]
mod support;

mod session;
#[cfg(target_os = "linux")]
mod window;
mod worker;
