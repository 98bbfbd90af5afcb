//! Loading in the background: one request at a time, the newest wins.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::geometry::AcceleratorKind;
use crate::io::memory;
use crate::io::progress::Step;
use crate::loader::{LoadError, Loaded, Source, Told, load_missing, load_telling};
use crate::scene::Assets;
use crate::threads;

/// A thread that loads files. Dropping it cancels and waits.
#[derive(Debug)]
pub struct Loader {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// What the loader is doing.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadProgress {
    /// Nothing.
    Idle,
    /// Reading and preparing this.
    Loading {
        /// What is opened.
        source: Source,
        /// The file at work, as the scene names it, and what is being done with it.
        step: Option<(String, Step)>,
    },
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

type Served = Result<Loaded, LoadError>;

#[derive(Debug, Default)]
struct State {
    request: Option<Request>,
    current: Option<Current>,
    result: Option<Served>,
    is_closing: bool,
}

/// What the thread is at.
#[derive(Debug)]
struct Current {
    source: Source,
    stop: Arc<AtomicBool>,
    step: Option<(String, Step)>,
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
        Self::serving(wake, serve)
    }

    fn serving(
        wake: impl Fn() + Send + 'static,
        serve: impl Fn(Request, &AtomicBool, &Told<'_>) -> Served + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared =
            Arc::new(Shared { state: Mutex::new(State::default()), changed: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let thread = threads::spawn("loader", move || theirs.run(wake, serve))?;
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
        self.shared.lock().cancel();
    }

    /// What is being loaded.
    pub fn progress(&self) -> LoadProgress {
        let state = self.shared.lock();
        match (&state.request, &state.current) {
            (Some(request), _) => {
                LoadProgress::Loading { source: request.source().clone(), step: None }
            }
            (None, Some(current)) => {
                LoadProgress::Loading { source: current.source.clone(), step: current.step.clone() }
            }
            (None, None) => LoadProgress::Idle,
        }
    }

    /// The newest result, once.
    pub fn take(&self) -> Option<Result<Loaded, LoadError>> {
        self.shared.lock().result.take()
    }

    fn request(&self, request: Request) {
        let mut state = self.shared.lock();
        if let Some(current) = &state.current {
            current.stop.store(true, Ordering::Relaxed);
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
            threads::part_from(thread);
        }
    }
}

impl State {
    fn cancel(&mut self) {
        self.request = None;
        self.result = None;
        if let Some(current) = self.current.take() {
            current.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, wake: impl Fn(), serve: impl Fn(Request, &AtomicBool, &Told<'_>) -> Served) {
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
            let source = request.source().clone();
            state.current = Some(Current { source, stop: Arc::clone(&stop), step: None });
            drop(state);
            let told = |file: &str, step| {
                let mut state = self.lock();
                if let Some(current) = &mut state.current
                    && Arc::ptr_eq(&current.stop, &stop)
                {
                    current.step = Some((file.to_owned(), step));
                }
            };
            let served = catch_unwind(AssertUnwindSafe(|| serve(request, &stop, &told)));
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

fn serve(request: Request, stop: &AtomicBool, told: &Told<'_>) -> Served {
    let loaded = match request {
        Request::Open(source) => load_telling(&source, &[], stop, told)?,
        Request::Complete(mut loaded) => {
            let Loaded { description, folder, assets, .. } = &*loaded;
            let (assets, files, report) =
                load_missing(description, folder, assets, stop, told).map_err(LoadError::Edit)?;
            loaded.assets = assets;
            for file in files {
                loaded.files.retain(|known| known.file != file.file);
                loaded.files.push(file);
            }
            loaded.report = report;
            *loaded
        }
    };
    build_trees(&loaded.assets, stop, told)?;
    Ok(loaded)
}

/// Builds the trees that a picture will ask for, so that the scene before is there until then.
fn build_trees(assets: &Assets, stop: &AtomicBool, told: &Told<'_>) -> Result<(), LoadError> {
    let kind = AcceleratorKind::default();
    for (key, asset) in &assets.meshes {
        if stop.load(Ordering::Relaxed) {
            return Err(LoadError::Cancelled);
        }
        let mesh = &asset.traced;
        let n_bytes = mesh.mesh.triangles.len() as u64 * kind.bytes_a_triangle();
        // Where memory or threads are missing, the renderer says so when it needs the tree.
        if mesh.has_tree(kind) || memory::check(n_bytes).is_err() {
            continue;
        }
        told(&key.file, Step::Tree);
        if let Ok(pool) = threads::background_pool("trees", threads::available()) {
            pool.install(|| mesh.build_tree(kind, stop)).map_err(|_| LoadError::Cancelled)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn a_mesh_comes_with_its_tree_and_each_step_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let steps = RefCell::new(Vec::new());
        let told = |file: &str, step| steps.borrow_mut().push((file.to_owned(), step));
        let request = || Request::Open(Source::File(path.clone()));
        let loaded = serve(request(), &AtomicBool::new(false), &told).unwrap();
        let expected = [Step::Normals, Step::Tree].map(|step| ("a.obj".to_owned(), step));
        assert_eq!(steps.into_inner(), expected, "other steps");
        let kind = AcceleratorKind::default();
        let mut meshes = loaded.assets.meshes.values();
        assert!(meshes.all(|mesh| mesh.traced.has_tree(kind)), "a tree is still to be built");
        let stopped = serve(request(), &AtomicBool::new(true), &|_, _| ());
        assert!(matches!(stopped, Err(LoadError::Cancelled)), "loaded though cancelled");
    }

    #[test]
    fn what_is_cancelled_never_comes_even_if_it_was_ready() {
        let (sender, woken) = std::sync::mpsc::channel();
        let loader = Loader::new(move || sender.send(()).unwrap()).unwrap();
        loader.open(Source::Gallery("pyramid"));
        woken.recv().unwrap();
        loader.cancel();
        assert!(loader.take().is_none(), "the cancelled scene came");
        assert_eq!(loader.progress(), LoadProgress::Idle, "still at it");
        loader.open(Source::Gallery("pyramid"));
        woken.recv().unwrap();
        assert!(loader.take().is_some(), "nothing is loaded any more");
    }
    /// Cancelled while the thread is at it, whatever it makes of that.
    #[test]
    fn what_is_cancelled_on_its_way_never_comes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(20_000));
        std::fs::write(&path, text).unwrap();
        let (sender, woken) = std::sync::mpsc::channel();
        let loader = Loader::new(move || sender.send(()).unwrap()).unwrap();
        let mut n_cancelled = 0;
        while n_cancelled < 5 {
            loader.open(Source::File(path.clone()));
            let is_cancelled = loop {
                let mut state = loader.shared.lock();
                if state.current.is_some() {
                    state.cancel();
                    break true;
                }
                if state.result.is_some() {
                    // It was quicker.
                    break false;
                }
            };
            woken.recv().unwrap();
            assert_eq!(loader.take().is_none(), is_cancelled, "the cancelled mesh came");
            n_cancelled += u32::from(is_cancelled);
        }
    }

    #[test]
    fn a_panic_fails_one_request_only() {
        let (sender, woken) = std::sync::mpsc::channel();
        let has_failed = AtomicBool::new(false);
        let serve_later = move |request, stop: &AtomicBool, told: &Told<'_>| {
            assert!(has_failed.swap(true, Ordering::Relaxed), "a mistake on purpose");
            serve(request, stop, told)
        };
        let loader = Loader::serving(move || sender.send(()).unwrap(), serve_later).unwrap();
        loader.open(Source::Gallery("pyramid"));
        woken.recv().unwrap();
        let told = loader.take().unwrap().unwrap_err().to_string();
        assert!(told.contains("a mistake on purpose"), "{told}");
        assert_eq!(loader.progress(), LoadProgress::Idle, "still at it");
        loader.open(Source::Gallery("pyramid"));
        woken.recv().expect("the loader lives");
        assert!(loader.take().is_some_and(|loaded| loaded.is_ok()), "nothing is loaded any more");
    }
}
