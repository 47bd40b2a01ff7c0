//! The context in which a thread makes calls: the tracing span of its work, and the purpose of the calls. It belongs to a thread and has
//! to be passed to other threads explicitly.

use std::cell::Cell;
use tracing::{Dispatch, Span, dispatcher, subscriber::NoSubscriber};

thread_local! {
    /// The purpose of this thread's calls, one word for a role such as `see` or `write`.
    static PURPOSE: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// The context of some work: the span that it is a part of, the subscriber that gets the spans, and the purpose of the calls.
#[derive(Debug, Clone)]
pub struct CallContext {
    /// The subscriber and the span; `None` if there is no subscriber.
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
        let dispatch = dispatcher::get_default(|current| (!current.is::<NoSubscriber>()).then(|| current.clone()));
        Self { watched: dispatch.map(|dispatch| (dispatch, Span::current())), purpose: Self::current_purpose() }
    }

    /// Runs a function in this context.
    pub fn run_within<T>(&self, work: impl FnOnce() -> T) -> T {
        let _guard = PurposeGuard(PURPOSE.replace(self.purpose));
        match &self.watched {
            Some((dispatch, span)) => dispatcher::with_default(dispatch, || span.in_scope(work)),
            None => work(),
        }
    }

    /// Runs a function with a purpose for its calls.
    pub fn with_purpose<T>(purpose: &'static str, work: impl FnOnce() -> T) -> T {
        let _guard = PurposeGuard(PURPOSE.replace(Some(purpose)));
        work()
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
