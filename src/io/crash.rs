//! When the program itself makes a mistake: a report of it in a file, and one line that says where.
//!
//! A report has what is needed to repeat the mistake: the version, what went wrong and where, the
//! calls that led there, and the scene that was open. It is sent nowhere.

use std::backtrace::Backtrace;
use std::cell::Cell;
use std::fs::OpenOptions;
use std::io::{Write, stderr};
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::io::memory::Limited;
use crate::io::{printable, printable_path};

/// Reports that one run writes at most; the first ones tell the most.
const MOST_REPORTS: usize = 3;
/// Reports that are kept in a folder; then somebody has to look at them.
const MOST_KEPT: u32 = 99;

/// What a report says beside the mistake itself.
static STATE: Mutex<State> = Mutex::new(State { folder: None, scene: None, written: Vec::new() });

thread_local! {
    /// Whether this thread runs what may panic.
    static IS_CONTAINED: Cell<bool> = const { Cell::new(false) };
}

struct State {
    folder: Option<PathBuf>,
    scene: Option<Arc<str>>,
    written: Vec<PathBuf>,
}

/// Reports every panic from now on, in this folder or in the system's folder for temporary files.
pub fn report_to(folder: Option<PathBuf>) {
    state().folder = folder;
    std::panic::set_hook(Box::new(|panic| {
        if is_contained() {
            return;
        }
        let line = match write_report(panic) {
            Some(path) => format!("; a report is in {}", printable_path(&path)),
            None => String::new(),
        };
        // Where stderr is closed, nobody is left to be told.
        let what = printable(&what_happened(panic));
        let _ = writeln!(stderr(), "error: penumbra made a mistake: {what}{line}");
    }));
}

/// Runs a foreign decoder, which may panic on damaged data. That is an answer, `None`, and no
/// mistake to report.
pub fn contain<T>(work: impl FnOnce() -> T) -> Option<T> {
    let before = IS_CONTAINED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work)).ok();
    IS_CONTAINED.set(before);
    result
}

/// Whether this thread runs a foreign decoder now, whose panic is no mistake.
pub fn is_contained() -> bool {
    IS_CONTAINED.get()
}

/// The text of the scene that is worked on from now on.
pub fn note_scene(text: impl Into<Arc<str>>) {
    state().scene = Some(text.into());
}

/// Makes a mistake on purpose where `PENUMBRA_MISTAKE` is set, to see what is told of it; never in a
/// program that was built to be used.
pub fn rehearse() {
    let is_asked = cfg!(debug_assertions) && std::env::var_os("PENUMBRA_MISTAKE").is_some();
    assert!(!is_asked, "a mistake on purpose");
}

/// Where this run's newest report is.
pub fn newest_report() -> Option<PathBuf> {
    state().written.last().cloned()
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn what_happened(panic: &PanicHookInfo<'_>) -> String {
    let message = panic.payload_as_str().unwrap_or("no message");
    let place = panic.location().map_or(String::new(), |place| format!(", at {place}"));
    format!("{message}{place}")
}

fn write_report(panic: &PanicHookInfo<'_>) -> Option<PathBuf> {
    // The mistake may have been made while this was locked.
    let mut state = match STATE.try_lock() {
        Ok(state) => state,
        Err(std::sync::TryLockError::Poisoned(state)) => state.into_inner(),
        Err(std::sync::TryLockError::WouldBlock) => return None,
    };
    if MOST_REPORTS <= state.written.len() {
        return None;
    }
    let thread = std::thread::current().name().unwrap_or("unnamed").to_owned();
    let calls = Backtrace::force_capture().to_string();
    let text = report(&what_happened(panic), &thread, &calls, state.scene.as_deref());
    let folders = [state.folder.clone(), Some(std::env::temp_dir())];
    let path = folders.iter().flatten().find_map(|folder| write_numbered(folder, &text))?;
    state.written.push(path.clone());
    Some(path)
}

fn report(what: &str, thread: &str, calls: &str, scene: Option<&str>) -> String {
    let (version, system) = (env!("CARGO_PKG_VERSION"), std::env::consts::OS);
    let processor = std::env::consts::ARCH;
    let scene = scene.unwrap_or("none was open\n");
    format!(
        "penumbra {version} for {system} on {processor} made a mistake in the thread {thread:?}:\n\
         {what}\n\n== the calls that led there ==\n{calls}\n== the scene ==\n{scene}"
    )
}

/// Writes to the first free of the names `crash-01.txt`, `crash-02.txt` and so on.
fn write_numbered(folder: &Path, text: &str) -> Option<PathBuf> {
    if Limited::now().file.is_some_and(|most| most < text.len() as u64) {
        return None;
    }
    std::fs::create_dir_all(folder).ok()?;
    for number in 1..=MOST_KEPT {
        let path = folder.join(format!("crash-{number:02}.txt"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut file) => return file.write_all(text.as_bytes()).is_ok().then_some(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(_) => return None,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_has_what_is_needed_to_repeat_the_mistake() {
        let calls = Backtrace::force_capture().to_string();
        let scene = "[camera]\neye = [0, 0, 1]\n";
        let text = report("index 3 of 2, at a.rs:1:2", "render-0", &calls, Some(scene));
        for part in [env!("CARGO_PKG_VERSION"), "index 3 of 2", "a.rs:1:2", "render-0", scene] {
            assert!(text.contains(part), "{part} is missing:\n{text}");
        }
        assert!(text.contains("a_report_has_what_is_needed"), "no calls:\n{text}");
    }

    #[test]
    fn reports_never_overwrite_one_another() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("not there yet");
        let paths = ["one", "two"].map(|text| write_numbered(&place, text).unwrap());
        assert_eq!(std::fs::read_to_string(&paths[0]).unwrap(), "one", "the first report");
        assert_eq!(paths[1].file_name().unwrap(), "crash-02.txt", "the second report");
        assert_eq!(write_numbered(Path::new("/dev/null/x"), "three"), None, "no such place");
    }
}
