//! What the system said before there was a window: eframe tells it to the log and to nobody else.

use std::sync::{Mutex, PoisonError};

/// What eframe writes before the reason why it stops.
const BEFORE_REASON: &str = "Exiting because of error: ";

/// Keeps the last reason why there is no window.
#[derive(Debug)]
pub(super) struct FaultKeeper {
    reason: Mutex<Option<String>>,
}

impl FaultKeeper {
    pub(super) const fn new() -> Self {
        Self { reason: Mutex::new(None) }
    }

    /// The reason, once.
    pub(super) fn take(&self) -> Option<String> {
        self.reason.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl log::Log for FaultKeeper {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.level() == log::Level::Error && metadata.target().starts_with("eframe")
    }

    fn log(&self, record: &log::Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let told = record.args().to_string();
        if let Some(reason) = told.strip_prefix(BEFORE_REASON) {
            let mut kept = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
            *kept = Some(reason.to_owned());
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use log::{Level, Log as _, Record};

    #[test]
    fn the_reason_why_there_is_no_window_is_kept_and_nothing_else() {
        let keeper = FaultKeeper::new();
        let say = |level, target, text: &str| {
            let mut record = Record::builder();
            keeper.log(&record.level(level).target(target).args(format_args!("{text}")).build());
        };
        say(Level::Error, "eframe::native::run", "Exiting because of error: no GLX");
        say(Level::Error, "eframe::native::run", "something else");
        say(Level::Error, "other", "Exiting because of error: other");
        say(Level::Debug, "eframe::native::run", "Exiting because of error: debug");
        assert_eq!(keeper.take().as_deref(), Some("no GLX"), "another reason");
        assert_eq!(keeper.take(), None, "it is told twice");
    }

    #[test]
    fn the_message_has_what_the_driver_says() {
        let told = |driver: Option<&str>| {
            super::super::no_window("there is no OpenGL".to_owned(), driver.map(str::to_owned))
        };
        assert_eq!(told(Some("no GLX")), "there is no OpenGL: no GLX", "the detail is lost");
        assert_eq!(told(None), "there is no OpenGL", "something is made up");
        assert_eq!(told(Some("there is no OpenGL")), "there is no OpenGL", "told twice");
    }
}
