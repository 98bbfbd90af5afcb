//! The one way to start threads: named, and in pools of their own.

use std::any::Any;
use std::io;
use std::thread::{Builder, JoinHandle};

/// Starts a named thread.
///
/// # Errors
/// When the system has no thread left.
pub fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    Builder::new().name(name.to_owned()).spawn(work)
}

/// A pool of `n_threads` (at least 1) named threads; never rayon's global one.
///
/// # Errors
/// When the system has no thread left.
pub fn pool(name: &'static str, n_threads: usize) -> io::Result<rayon::ThreadPool> {
    started(n_threads, builder(name, n_threads))
}

/// The same with as many threads as somebody asked for. Where nobody did: one a processor, or fewer
/// where the system has not so many left.
///
/// # Errors
/// When the system has no thread left, or fewer than were asked for.
pub fn pool_of(name: &'static str, n_wanted: Option<u32>) -> io::Result<rayon::ThreadPool> {
    match n_wanted {
        Some(n) => pool(name, n as usize),
        None => or_fewer(available(), |n| pool(name, n)),
    }
}

/// [`pool`] at lower priority where the system has one, so that the desktop stays usable.
///
/// # Errors
/// When the system has no thread left.
pub fn background_pool(name: &'static str, n_threads: usize) -> io::Result<rayon::ThreadPool> {
    started(n_threads, builder(name, n_threads).start_handler(|_| lower_priority()))
}

fn builder(name: &'static str, n_threads: usize) -> rayon::ThreadPoolBuilder {
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads.max(1))
        .thread_name(move |index| format!("{name}-{index}"))
}

fn started(n_threads: usize, builder: rayon::ThreadPoolBuilder) -> io::Result<rayon::ThreadPool> {
    builder.build().map_err(|error| {
        io::Error::other(match n_threads {
            1 => format!("cannot start a thread: {error}; end other programs first"),
            n => format!("cannot start {n} threads: {error}; give a smaller number"),
        })
    })
}

/// What `start` makes of a number, or of half of it, and so on; of 1 it has to.
fn or_fewer<T>(mut n: usize, start: impl Fn(usize) -> io::Result<T>) -> io::Result<T> {
    loop {
        match start(n) {
            Err(_) if 1 < n => n /= 2,
            result => return result,
        }
    }
}

fn lower_priority() {
    // On Linux niceness belongs to the thread.
    #[cfg(target_os = "linux")]
    {
        // Rendering at normal priority is no failure.
        let _ = rustix::process::nice(10);
    }
}

/// What a panic said.
pub fn panic_text(panic: &(dyn Any + Send)) -> String {
    let owned = panic.downcast_ref::<String>().cloned();
    let text = || panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    owned.or_else(text).unwrap_or_else(|| "an unknown failure".to_owned())
}

/// Processors that this process may use, at least 1.
pub fn available() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// How many of [`background_pool`] go with a window: all but one, for what else the machine does, or
/// both of two, of which the window, at its higher priority, gets what it needs.
pub fn beside_window() -> usize {
    const FEW: usize = 2;
    let n = available();
    if n <= FEW { n } else { n - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_threads_are_scarce_fewer_do() {
        let scarce = |most| {
            move |n| if n <= most { Ok(n) } else { Err(io::Error::other(format!("{n} are many"))) }
        };
        assert_eq!(or_fewer(12, scarce(100)).unwrap(), 12, "there are enough");
        assert_eq!(or_fewer(12, scarce(4)).unwrap(), 3, "there are four");
        assert_eq!(or_fewer(12, scarce(0)).unwrap_err().to_string(), "1 are many", "there is none");
    }
}
