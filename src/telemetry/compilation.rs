//! Progress of kernel compilation, which takes up to a minute on a software driver.

use std::sync::OnceLock;

/// A kernel that a driver is compiling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compilation<'a> {
    /// Device name.
    pub device: &'a str,
    /// Kernel name.
    pub kernel: &'static str,
    /// Number of kernels that are ready.
    pub done: usize,
    /// Number of kernels to compile, at least 1.
    pub of: usize,
}

type Observer = Box<dyn Fn(Option<&Compilation>) + Send + Sync>;

static OBSERVER: OnceLock<Observer> = OnceLock::new();

/// Registers an observer for the whole process. It is called when the compilation of a kernel
/// starts, and with `None` when the kernels of an engine are ready or have failed. Returns false if
/// an observer is already registered, which then stays in place.
pub fn observe(observer: impl Fn(Option<&Compilation>) + Send + Sync + 'static) -> bool {
    OBSERVER.set(Box::new(observer)).is_ok()
}

/// Compilation of the kernels of an engine. Ends when dropped.
pub(crate) struct Running<'a> {
    device: &'a str,
    begun: usize,
    of: usize,
}

impl<'a> Running<'a> {
    /// Starts the compilation of `of` kernels and reports the first, if there is one.
    pub(crate) fn new(device: &'a str, first: Option<&'static str>, of: usize) -> Self {
        let running = Self { device, begun: 0, of };
        if let Some(first) = first {
            running.tell(first, 0);
        }
        running
    }

    /// Reports that the compilation of a kernel starts; all earlier ones are done.
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

/// Theory: the observer is called when each kernel starts, with the number of completed ones, and
/// at the end. An engine without kernels to compile reports nothing.
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
