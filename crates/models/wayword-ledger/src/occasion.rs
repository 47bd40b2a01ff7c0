//! On what occasion calls are made. It belongs to a thread, and is handed to other threads explicitly.

use std::cell::Cell;
use tracing::{Dispatch, Span, dispatcher, subscriber::NoSubscriber};

thread_local! {
    static PURPOSE: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// On what occasion something is done: the span that it is a part of, who watches, and what calls are for.
#[derive(Debug, Clone)]
pub struct Occasion {
    /// `None` if nobody watches.
    watched: Option<(Dispatch, Span)>,
    purpose: Option<&'static str>,
}

/// Puts the purpose back, also after a panic.
struct Before(Option<&'static str>);

impl Drop for Before {
    fn drop(&mut self) {
        PURPOSE.set(self.0);
    }
}

impl Occasion {
    /// The occasion of this thread, for work that goes on in another one.
    #[must_use]
    pub fn here() -> Self {
        let dispatch = dispatcher::get_default(|to| (!to.is::<NoSubscriber>()).then(|| to.clone()));
        Self { watched: dispatch.map(|to| (to, Span::current())), purpose: Self::purpose() }
    }

    /// Does something on this occasion.
    pub fn on<T>(&self, does: impl FnOnce() -> T) -> T {
        let _before = Before(PURPOSE.replace(self.purpose));
        match &self.watched {
            Some((to, span)) => dispatcher::with_default(to, || span.in_scope(does)),
            None => does(),
        }
    }

    /// Does something whose calls are for this purpose.
    pub fn with_purpose<T>(purpose: &'static str, does: impl FnOnce() -> T) -> T {
        let _before = Before(PURPOSE.replace(Some(purpose)));
        does()
    }

    /// What calls of this thread are for, if that is known.
    pub(crate) fn purpose() -> Option<&'static str> {
        PURPOSE.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{panic::catch_unwind, thread};

    #[test]
    fn a_purpose_holds_for_its_work_alone_and_goes_along_to_other_threads() {
        Occasion::with_purpose("write", || {
            let occasion = Occasion::here();
            thread::scope(|scope| {
                let seen = scope.spawn(|| (Occasion::purpose(), occasion.on(Occasion::purpose), Occasion::purpose()));
                assert_eq!(seen.join().unwrap(), (None, Some("write"), None));
            });
            let ended = catch_unwind(|| Occasion::with_purpose("see", || panic!("on purpose")));
            assert!(ended.is_err() && Occasion::purpose() == Some("write"));
        });
        assert_eq!(Occasion::purpose(), None);
    }
}
