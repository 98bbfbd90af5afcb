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
        let mut seen = Seen::default();
        while let Some((paths, current)) = self.next_look() {
            if current != number {
                (number, seen) = (current, Seen::new(self.lock().stamps.clone()));
            }
            if seen.is_news(paths.iter().map(stamp).collect()) {
                self.lock().has_news = true;
                wake();
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

/// What the looks at the files have seen.
#[derive(Debug, Default)]
struct Seen {
    /// What was told last.
    known: Vec<Stamp>,
    /// A change that has still to rest.
    pending: Option<Vec<Stamp>>,
}

impl Seen {
    fn new(known: Vec<Stamp>) -> Self {
        Self { known, pending: None }
    }

    /// Whether the files have changed and have rested since the last look. One that is gone is
    /// being written anew.
    fn is_news(&mut self, stamps: Vec<Stamp>) -> bool {
        if self.pending.as_ref() == Some(&stamps) {
            *self = Self::new(stamps);
            return true;
        }
        let has_changed = stamps != self.known && stamps.iter().all(Option::is_some);
        self.pending = has_changed.then_some(stamps);
        false
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

    #[test]
    fn a_change_is_news_once_it_is_the_same_at_two_looks() {
        let stamps = |lengths: [Option<u64>; 2]| -> Vec<Stamp> {
            lengths.map(|length| Some((SystemTime::UNIX_EPOCH, length?))).to_vec()
        };
        let (old, half) = (stamps([Some(1), Some(2)]), stamps([Some(1), Some(5)]));
        let (gone, whole) = (stamps([Some(1), None]), stamps([Some(1), Some(9)]));
        let mut seen = Seen::new(old.clone());
        for (look, (now, is_news)) in [
            (&old, false),
            (&half, false),
            (&whole, false),
            (&whole, true),
            (&whole, false),
            (&gone, false),
            (&gone, false),
            (&whole, false),
            (&old, false),
            (&whole, false),
            (&whole, false),
            (&half, false),
            (&half, true),
        ]
        .into_iter()
        .enumerate()
        {
            assert_eq!(seen.is_news(now.clone()), is_news, "at look {look}");
        }
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
