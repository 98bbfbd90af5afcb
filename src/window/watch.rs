//! Notices when another program changes a file of the open scene.

use crate::threads;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

/// How often the files are looked at. A change counts once it has rested this long, so that a
/// half-written file is not read.
const PERIOD: Duration = Duration::from_millis(500);

/// A thread that looks at a few files, and sleeps while there are none.
pub(super) struct Watcher {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    list: Mutex<List>,
    changed: Condvar,
}

#[derive(Default)]
struct List {
    paths: Vec<PathBuf>,
    /// Of the files when the list was made: what changes before the thread's first look counts.
    stamps: Vec<Stamp>,
    /// Counts the lists.
    number: u64,
    has_news: bool,
    closing: bool,
}

type Stamp = Option<(SystemTime, u64)>;

impl Watcher {
    /// Starts the thread; `wake` is called after a change.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let shared =
            Arc::new(Shared { list: Mutex::new(List::default()), changed: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let thread = threads::spawn("watch", move || theirs.watch(&wake))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Watches these files, as they are now, instead of those before.
    pub(super) fn watch(&self, paths: Vec<PathBuf>) {
        let stamps = paths.iter().map(stamp).collect();
        self.shared.lock().renew(paths, stamps);
        self.shared.changed.notify_one();
    }

    /// Whether a file was changed, once.
    pub(super) fn take_news(&self) -> bool {
        std::mem::take(&mut self.shared.lock().has_news)
    }
}

#[cfg(test)]
impl Watcher {
    /// Whether that file is looked at.
    pub(super) fn watches(&self, path: &std::path::Path) -> bool {
        self.shared.lock().paths.iter().any(|watched| watched == path)
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.shared.lock().closing = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic over there has nothing left to break here.
            let _ = thread.join();
        }
    }
}

impl List {
    fn renew(&mut self, paths: Vec<PathBuf>, stamps: Vec<Stamp>) {
        (self.paths, self.stamps) = (paths, stamps);
        self.number += 1;
        self.has_news = false;
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, List> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn watch(&self, wake: &impl Fn()) {
        let mut number = 0;
        let mut known: Vec<Stamp> = Vec::new();
        let mut pending: Option<Vec<Stamp>> = None;
        while let Some((paths, current)) = self.next_look() {
            if current != number {
                (number, known, pending) = (current, self.lock().stamps.clone(), None);
            }
            let stamps: Vec<Stamp> = paths.iter().map(stamp).collect();
            if pending.as_ref() == Some(&stamps) {
                // It changed and has rested since.
                (known, pending) = (stamps, None);
                self.lock().has_news = true;
                wake();
            } else {
                pending = (stamps != known && stamps.iter().all(Option::is_some)).then_some(stamps);
            }
        }
    }

    /// Waits for the next look at the files; without files, for some to come.
    fn next_look(&self) -> Option<(Vec<PathBuf>, u64)> {
        let list = self.lock();
        let before = list.number;
        let list = if list.paths.is_empty() {
            let idle = |list: &mut List| list.paths.is_empty() && !list.closing;
            self.changed.wait_while(list, idle).unwrap_or_else(PoisonError::into_inner)
        } else {
            let same = |list: &mut List| list.number == before && !list.closing;
            let waited = self.changed.wait_timeout_while(list, PERIOD, same);
            waited.unwrap_or_else(PoisonError::into_inner).0
        };
        (!list.closing).then(|| (list.paths.clone(), list.number))
    }
}

fn stamp(path: &PathBuf) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_changed_file_is_noticed_once_it_rests() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "one").unwrap();
        let (sender, woken) = channel();
        let watcher = Watcher::new(move || sender.send(()).unwrap()).unwrap();
        watcher.watch(vec![path.clone()]);
        assert!(woken.recv_timeout(PERIOD * 3).is_err(), "news without a change");
        std::fs::write(&path, "three").unwrap();
        woken.recv_timeout(Duration::from_secs(20)).expect("the change is noticed");
        assert!(watcher.take_news(), "woken without news");
        assert!(!watcher.take_news(), "the same news twice");
    }

    /// Before the thread has looked for the first time.
    #[test]
    fn a_file_changed_at_once_is_noticed_too() {
        let folder = tempfile::tempdir().unwrap();
        let (sender, woken) = channel();
        let watcher = Watcher::new(move || sender.send(()).unwrap()).unwrap();
        for round in 0..3 {
            let path = folder.path().join(format!("{round}.toml"));
            std::fs::write(&path, "one").unwrap();
            let mut list = watcher.shared.lock();
            list.renew(vec![path.clone()], vec![stamp(&path)]);
            std::fs::write(&path, "three").unwrap();
            drop(list);
            watcher.shared.changed.notify_one();
            woken.recv_timeout(Duration::from_secs(20)).expect("the change is noticed");
            assert!(watcher.take_news(), "woken without news");
        }
    }
}
