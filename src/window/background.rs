//! One thread that does one kind of work for the window, newest order first, older ones forgotten.

use crate::threads;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// A named thread with a place for one order and a place for one result.
pub(super) struct Background<Order, Done> {
    shared: Arc<Shared<Order, Done>>,
    thread: Option<JoinHandle<()>>,
}

struct Shared<Order, Done> {
    places: Mutex<Places<Order, Done>>,
    changed: Condvar,
}

struct Places<Order, Done> {
    order: Option<Order>,
    done: Option<Done>,
    closing: bool,
}

impl<Order: Send + 'static, Done: Send + 'static> Background<Order, Done> {
    /// Starts the thread. `work` makes a result of an order; `wake` is called after each, without
    /// a lock.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(
        name: &str,
        mut work: impl FnMut(Order) -> Done + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let places = Mutex::new(Places { order: None, done: None, closing: false });
        let shared = Arc::new(Shared { places, changed: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let thread = threads::spawn(name, move || {
            while let Some(order) = theirs.next_order() {
                let done = work(order);
                theirs.lock().done = Some(done);
                wake();
            }
        })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Leaves an order; one that has not been begun is forgotten.
    pub(super) fn order(&self, order: Order) {
        self.shared.lock().order = Some(order);
        self.shared.changed.notify_one();
    }

    /// Takes back an order that has not been begun; what is being made comes all the same.
    pub(super) fn forget(&self) {
        self.shared.lock().order = None;
    }

    /// The newest result, once.
    pub(super) fn take(&self) -> Option<Done> {
        self.shared.lock().done.take()
    }
}

impl<Order, Done> Drop for Background<Order, Done> {
    fn drop(&mut self) {
        self.shared.lock().closing = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic over there has nothing left to break here.
            let _ = thread.join();
        }
    }
}

impl<Order, Done> Shared<Order, Done> {
    fn lock(&self) -> MutexGuard<'_, Places<Order, Done>> {
        self.places.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The newest order, waited for; `None` when the window closes.
    fn next_order(&self) -> Option<Order> {
        let mut places = self.lock();
        loop {
            if places.closing {
                return None;
            }
            if let Some(order) = places.order.take() {
                return Some(order);
            }
            places = self.changed.wait(places).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn orders_that_were_overtaken_are_never_worked_on() {
        let (begun_sender, begun) = channel();
        let (gate_sender, gate) = channel();
        let (woken_sender, woken) = channel();
        let background = Background::new(
            "test",
            move |order: u32| {
                begun_sender.send(order).unwrap();
                gate.recv().unwrap();
                order
            },
            move || woken_sender.send(()).unwrap(),
        )
        .unwrap();
        background.order(1);
        assert_eq!(begun.recv().unwrap(), 1, "the first order waits");
        background.order(2);
        background.order(3);
        gate_sender.send(()).unwrap();
        woken.recv().unwrap();
        assert_eq!(begun.recv().unwrap(), 3, "an overtaken order was begun");
        gate_sender.send(()).unwrap();
        woken.recv().unwrap();
        assert_eq!(background.take(), Some(3), "the newest result is not there");
        assert_eq!(background.take(), None, "a result was given twice");
    }
}
