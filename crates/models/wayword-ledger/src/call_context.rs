//! The context in which a thread makes calls: the tracing span of its work, and the purpose of the calls. It belongs to a thread and has
//! to be passed to other threads explicitly.

use std::cell::Cell;
use tracing::{Dispatch, Span, dispatcher, subscriber::NoSubscriber};

thread_local! {
    static PURPOSE: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// The context of some work: the span that it is a part of, the subscriber that gets the spans, and the purpose of the calls.
#[derive(Debug, Clone)]
pub struct CallContext {
    /// `None` if there is no subscriber.
    watched: Option<(Dispatch, Span)>,
    purpose: Option<&'static str>,
}

/// Restores the previous purpose of the thread when it is dropped, also after a panic.
struct PurposeGuard(Option<&'static str>);

impl Drop for PurposeGuard {
    fn drop(&mut self) {
        PURPOSE.set(self.0);
    }
}

impl CallContext {
    /// The context of this thread, for work that goes on in another one.
    #[must_use]
    pub fn from_current_thread() -> Self {
        let dispatch = dispatcher::get_default(|to| (!to.is::<NoSubscriber>()).then(|| to.clone()));
        Self { watched: dispatch.map(|to| (to, Span::current())), purpose: Self::current_purpose() }
    }

    /// Runs a function in this context.
    pub fn run_within<T>(&self, does: impl FnOnce() -> T) -> T {
        let _before = PurposeGuard(PURPOSE.replace(self.purpose));
        match &self.watched {
            Some((to, span)) => dispatcher::with_default(to, || span.in_scope(does)),
            None => does(),
        }
    }

    /// Runs a function with a purpose for its calls.
    pub fn with_purpose<T>(purpose: &'static str, does: impl FnOnce() -> T) -> T {
        let _before = PurposeGuard(PURPOSE.replace(Some(purpose)));
        does()
    }

    /// The purpose of this thread's calls, if it was set.
    pub(crate) fn current_purpose() -> Option<&'static str> {
        PURPOSE.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{panic::catch_unwind, thread};

    #[test]
    fn a_purpose_holds_for_its_work_alone_and_goes_along_to_other_threads() {
        CallContext::with_purpose("write", || {
            let occasion = CallContext::from_current_thread();
            thread::scope(|scope| {
                let seen = scope.spawn(|| {
                    (
                        CallContext::current_purpose(),
                        occasion.run_within(CallContext::current_purpose),
                        CallContext::current_purpose(),
                    )
                });
                assert_eq!(seen.join().unwrap(), (None, Some("write"), None));
            });
            let ended = catch_unwind(|| CallContext::with_purpose("see", || panic!("on purpose")));
            assert!(ended.is_err() && CallContext::current_purpose() == Some("write"));
        });
        assert_eq!(CallContext::current_purpose(), None);
    }
}
