//! Progress of the compilation of kernels, for a program that shows it. A software driver takes up
//! to a minute for large scenes.

use std::sync::OnceLock;

/// A kernel that a driver is compiling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compilation<'a> {
    /// The device's name.
    pub device: &'a str,
    /// The kernel's name.
    pub kernel: &'static str,
    /// Kernels that are ready.
    pub done: usize,
    /// Kernels to compile, from 1.
    pub of: usize,
}

type Observer = Box<dyn Fn(Option<&Compilation>) + Send + Sync>;

static OBSERVER: OnceLock<Observer> = OnceLock::new();

/// Calls `observer` from now on, for each kernel that is begun and with `None` when an engine's
/// kernels are ready or have failed. The first observer of a process stays; returns whether this is
/// it.
pub fn observe(observer: impl Fn(Option<&Compilation>) + Send + Sync + 'static) -> bool {
    OBSERVER.set(Box::new(observer)).is_ok()
}

/// The compilation of an engine's kernels; ends when dropped.
pub(crate) struct Running<'a> {
    device: &'a str,
    begun: usize,
    of: usize,
}

impl<'a> Running<'a> {
    /// Begins with the first of `of` kernels, if there are any.
    pub(crate) fn new(device: &'a str, first: Option<&'static str>, of: usize) -> Self {
        let running = Self { device, begun: 0, of };
        if let Some(first) = first {
            running.tell(first, 0);
        }
        running
    }

    /// Hands a kernel to the driver, which is done with those before.
    pub(crate) fn begin(&mut self, kernel: &'static str) {
        self.tell(kernel, self.begun);
        self.begun += 1;
    }

    fn tell(&self, kernel: &'static str, done: usize) {
        if let Some(observer) = OBSERVER.get() {
            observer(Some(&Compilation { device: self.device, kernel, done, of: self.of }));
        }
    }
}

impl Drop for Running<'_> {
    fn drop(&mut self) {
        if let Some(observer) = OBSERVER.get().filter(|_| self.of > 0) {
            observer(None);
        }
    }
}

/// Theory: an observer hears of each kernel once it is begun, with those before it done, and of the
/// end. An engine whose kernels are all kept says nothing.
#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());

    #[test]
    fn each_kernel_is_heard_of() {
        assert!(observe(|event| {
            let text = event.map_or("end".to_owned(), |c| {
                format!("{} {} {}/{}", c.device, c.kernel, c.done, c.of)
            });
            HEARD.lock().unwrap().push(text);
        }));
        assert!(!observe(|_| ()));
        let mut running = Running::new("it", Some("a"), 2);
        running.begin("a");
        running.begin("b");
        drop(running);
        drop(Running::new("it", None, 0));
        // other tests of this process may compile too
        let mut heard = HEARD.lock().unwrap().clone();
        heard.retain(|line| line.starts_with("it ") || line == "end");
        assert_eq!(heard[..4], ["it a 0/2", "it a 0/2", "it b 1/2", "end"]);
    }
}
