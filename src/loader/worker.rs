//! Loading in the background: one request at a time, the newest wins.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::io::folder::{FileRecord, Folder};
use crate::loader::{LoadError, Loaded, Source, load, load_missing};
use crate::scene::Assets;
use crate::scene::description::SceneDescription;
use crate::threads;

/// A thread that loads files. Dropping it cancels and waits.
#[derive(Debug)]
pub struct Loader {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// What the loader is doing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadProgress {
    /// Nothing.
    Idle,
    /// Reading and preparing this.
    Loading(Source),
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    request: Option<Request>,
    current: Option<(Source, Arc<AtomicBool>)>,
    result: Option<Result<Loaded, LoadError>>,
    is_closing: bool,
}

#[derive(Debug)]
enum Request {
    Open(Source),
    /// What an edited scene lacks.
    Complete(Box<Loaded>),
}

impl Request {
    fn source(&self) -> &Source {
        match self {
            Self::Open(source) => source,
            Self::Complete(loaded) => &loaded.source,
        }
    }
}

impl Loader {
    /// Starts the thread. `wake` is called, without locks, when a result is there.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn new(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared =
            Arc::new(Shared { state: Mutex::new(State::default()), changed: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let thread = threads::spawn("loader", move || theirs.run(wake))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Asks for a file; an older request is cancelled.
    pub fn open(&self, source: Source) {
        self.request(Request::Open(source));
    }

    /// Asks for the files that an edited description names and its assets lack. The result is the
    /// whole scene again, as after [`Loader::open`].
    pub fn complete(&self, loaded: Loaded) {
        self.request(Request::Complete(Box::new(loaded)));
    }

    /// Drops the current request, if any; its result will not come.
    pub fn cancel(&self) {
        let mut state = self.shared.lock();
        state.request = None;
        if let Some((_, stop)) = state.current.take() {
            stop.store(true, Ordering::Relaxed);
        }
    }

    /// What is being loaded.
    pub fn progress(&self) -> LoadProgress {
        let state = self.shared.lock();
        let waiting = state.request.as_ref().map(Request::source);
        let source = waiting.or(state.current.as_ref().map(|(source, _)| source));
        source.map_or(LoadProgress::Idle, |source| LoadProgress::Loading(source.clone()))
    }

    /// The newest result, once.
    pub fn take(&self) -> Option<Result<Loaded, LoadError>> {
        self.shared.lock().result.take()
    }

    fn request(&self, request: Request) {
        let mut state = self.shared.lock();
        if let Some((_, stop)) = &state.current {
            stop.store(true, Ordering::Relaxed);
        }
        state.request = Some(request);
        state.result = None;
        self.shared.changed.notify_one();
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.cancel();
        self.shared.lock().is_closing = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, wake: impl Fn()) {
        loop {
            let mut state = self.lock();
            while state.request.is_none() && !state.is_closing {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            if state.is_closing {
                return;
            }
            let Some(request) = state.request.take() else { continue };
            let stop = Arc::new(AtomicBool::new(false));
            state.current = Some((request.source().clone(), Arc::clone(&stop)));
            drop(state);
            let served = catch_unwind(AssertUnwindSafe(|| serve(request, &stop)));
            let result =
                served.unwrap_or_else(|panic| Err(LoadError::Failed(threads::panic_text(&*panic))));
            let mut state = self.lock();
            // A cancelled or outdated request leaves no trace.
            if !stop.load(Ordering::Relaxed) {
                state.current = None;
                state.result = Some(result);
            }
            drop(state);
            wake();
        }
    }
}

fn serve(request: Request, stop: &AtomicBool) -> Result<Loaded, LoadError> {
    match request {
        Request::Open(source) => load(&source, &[], stop),
        Request::Complete(mut loaded) => {
            let (assets, files, report) =
                missing(&loaded.description, &loaded.folder, &loaded.assets, stop)?;
            loaded.assets = assets;
            for file in files {
                loaded.files.retain(|known| known.file != file.file);
                loaded.files.push(file);
            }
            loaded.report = report;
            Ok(*loaded)
        }
    }
}

type Missing = (Assets, Vec<FileRecord>, Vec<String>);

fn missing(
    description: &SceneDescription,
    folder: &Folder,
    assets: &Assets,
    stop: &AtomicBool,
) -> Result<Missing, LoadError> {
    load_missing(description, folder, assets, stop).map_err(LoadError::Edit)
}
