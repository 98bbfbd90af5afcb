//! The one way to start threads: named, and in pools of their own.

use std::any::Any;
use std::hint::black_box;
use std::io;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Bytes of stack that every thread has.
pub const STACK: usize = 2 << 20;

/// Starts a named thread.
///
/// # Errors
/// When the system has no thread left.
pub fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    Builder::new().name(name.to_owned()).stack_size(STACK).spawn(work)
}

/// A pool of `n_threads` (at least 1) named threads; never rayon's global one. Each has taken what
/// it needs to begin with, so that what is free afterwards is free.
///
/// # Errors
/// When the system has no thread left.
pub fn pool(name: &'static str, n_threads: usize) -> io::Result<rayon::ThreadPool> {
    let pool = started(n_threads, builder(name, n_threads))?;
    // An allocator may set much aside at a thread's first request.
    pool.broadcast(|_| drop(black_box(Box::new(0_u8))));
    Ok(pool)
}

/// [`pool`] of `n_threads`, or of fewer where the system has not so many left.
///
/// # Errors
/// When the system has no thread left.
pub fn pool_of_at_most(name: &'static str, n_threads: usize) -> io::Result<rayon::ThreadPool> {
    or_fewer(n_threads, |n| pool(name, n))
}

/// A pool that is the thread that asks for it, and takes nothing; no thread may do so twice.
///
/// # Errors
/// When it has done so.
pub fn pool_of_caller() -> io::Result<rayon::ThreadPool> {
    started(1, rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread())
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
        .stack_size(STACK)
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

/// Waits a second for a thread that was told to end; one that is deep in its work by then is left to
/// end by itself, or with the process.
pub fn part_from(thread: JoinHandle<()>) {
    const PATIENCE: Duration = Duration::from_secs(1);
    const LOOK: Duration = Duration::from_millis(2);
    let start = Instant::now();
    while !thread.is_finished() && start.elapsed() < PATIENCE {
        std::thread::sleep(LOOK);
    }
    if thread.is_finished() {
        // A panic has been reported where it happened.
        let _ = thread.join();
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
    fn nobody_waits_for_a_thread_that_does_not_end() {
        let (end, wait) = std::sync::mpsc::channel::<()>();
        let (tell, told) = std::sync::mpsc::channel();
        let work = move || {
            let _ = wait.recv();
            let _ = tell.send("ended");
        };
        part_from(spawn("slow", work).unwrap());
        assert!(told.try_recv().is_err(), "it is still there");
        drop(end);
        assert_eq!(told.recv(), Ok("ended"), "by itself");
        let (tell, told) = std::sync::mpsc::channel();
        let work = move || {
            let _ = tell.send("ended");
        };
        part_from(spawn("quick", work).unwrap());
        assert_eq!(told.try_recv(), Ok("ended"), "waited for");
    }

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
