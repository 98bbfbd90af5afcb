//! Opening, saving and snapshots: what is under way and what came of it, on threads of their own.

use crate::io::folder::{FileRecord, Folder};
use crate::loader::{Loader, Source};
use crate::scene::description::SceneDescription;
use crate::scene::resolve::ResolveError;
use crate::threads;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Where the open scene came from, and what is being loaded or written.
pub(super) struct FileWork {
    pub(super) loader: Loader,
    /// What is shown as the scene's name.
    pub(super) title: String,
    /// The scene file that "save" writes; `None` where there is none yet.
    pub(super) scene_path: Option<PathBuf>,
    /// Where the scene's relative paths start from.
    pub(super) folder: Folder,
    /// The files that the scene uses.
    pub(super) records: Vec<FileRecord>,
    /// What loading had to repair or leave out.
    pub(super) report: Vec<String>,
    /// Name of what is being loaded.
    pub(super) loading: Option<String>,
    /// What was opened.
    pub(super) source: Option<Source>,
    /// Whether what is being loaded completes an edited scene.
    pub(super) is_completing: bool,
    /// Whether what is being loaded is the open scene again, changed by another program.
    pub(super) is_reloading: bool,
    /// What was said of a changed file that could not be loaded; it settles itself.
    pub(super) reload_fault: Option<String>,
    /// What an edited scene lacked when it was last looked at.
    pub(super) missing: Option<ResolveError>,
    /// Whether a scene has been opened at all.
    pub(super) has_scene: bool,
    /// Whether edits are being saved so that `pending` can go on.
    pub(super) is_saving_first: bool,
    /// Whether the window may close with unsaved edits.
    pub(super) close_confirmed: bool,
    /// What waits for an answer about unsaved edits.
    pub(super) pending: Option<Pending>,
    sender: Sender<Written>,
    written: Receiver<Written>,
}

/// What goes on once unsaved edits are saved or let go.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Pending {
    /// Close the window.
    Close,
    /// Close the scene and show the start page.
    CloseScene,
    /// Open something else.
    Open(Source),
}

/// The end of a task that wrote a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Written {
    /// The scene as it was then is in that file now.
    Scene {
        /// Where.
        path: PathBuf,
        /// As the window knew it.
        description: Box<SceneDescription>,
    },
    /// The picture is in that file.
    Snapshot(PathBuf),
    /// The small picture of an opened file, or none: the page has to look again.
    RecentPicture,
    /// A copy is kept in case of a crash.
    Copy,
    /// No copy could be kept, for that reason.
    NoCopy(String),
    /// Nothing was written, for that reason.
    Failed(String),
}

impl FileWork {
    /// Nothing open yet.
    pub(super) fn new(loader: Loader) -> Self {
        let (sender, written) = channel();
        Self {
            loader,
            title: "untitled".to_owned(),
            scene_path: None,
            folder: Folder::Gallery,
            records: Vec::new(),
            report: Vec::new(),
            loading: None,
            source: None,
            is_completing: false,
            is_reloading: false,
            reload_fault: None,
            missing: None,
            has_scene: false,
            is_saving_first: false,
            close_confirmed: false,
            pending: None,
            sender,
            written,
        }
    }

    /// Starts loading; the scene that is open stays until the new one is ready.
    pub(super) fn open(&mut self, source: Source) {
        // Recent files are opened from other folders, too.
        let source = match source {
            Source::File(path) => Source::File(std::path::absolute(&path).unwrap_or(path)),
            Source::Gallery(name) => Source::Gallery(name),
        };
        self.is_completing = false;
        self.is_reloading = false;
        self.loading = Some(source.stem());
        self.loader.open(source);
    }

    /// Forgets the open scene and stops loading another.
    pub(super) fn close_scene(&mut self) {
        self.cancel_loading();
        self.title = "untitled".to_owned();
        self.scene_path = None;
        self.folder = Folder::Gallery;
        self.records.clear();
        self.report.clear();
        self.source = None;
        self.missing = None;
        self.has_scene = false;
    }

    /// Stops loading. False where nothing was being loaded.
    pub(super) fn cancel_loading(&mut self) -> bool {
        let was_loading = self.loading.take().is_some();
        if was_loading {
            self.loader.cancel();
        }
        was_loading
    }

    /// Runs a task that writes a file, off the window's thread.
    pub(super) fn write(
        &self,
        ctx: &egui::Context,
        task: impl FnOnce() -> Written + Send + 'static,
    ) {
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        let started = threads::spawn("write", move || {
            // The window may be gone; then nobody waits for the answer.
            let _ = sender.send(task());
            ctx.request_repaint();
        });
        if let Err(error) = started {
            let _ = self.sender.send(Written::Failed(format!("cannot start writing: {error}")));
        }
    }

    /// The end of a task, once.
    pub(super) fn take_written(&self) -> Option<Written> {
        self.written.try_recv().ok()
    }
}

/// A file's name without folder and ending.
pub(super) fn file_title(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
