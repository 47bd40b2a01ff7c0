//! The context in which a thread makes calls: the tracing span of its work, the purpose of the calls, and the account that counts them. It belongs to a thread and has
//! to be passed to other threads explicitly.

use crate::CallAnswer;
use std::{
    cell::{Cell, RefCell},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};
use tracing::{Dispatch, Span, dispatcher, subscriber::NoSubscriber};

thread_local! {
    /// The purpose of this thread's calls, one word for a role such as `see` or `write`.
    static PURPOSE: Cell<Option<&'static str>> = const { Cell::new(None) };
    /// The account that counts the answers that this thread uses.
    static ACCOUNT: RefCell<Option<CallAccount>> = const { RefCell::new(None) };
}

/// Counts the answers that some work uses, and what they cost when they were made. Answers of the ledger count like new ones, so the
/// totals are the same each time. Clones count together.
#[derive(Debug, Clone, Default)]
pub struct CallAccount(Arc<AccountCounts>);

/// The counts of an account. Money is counted in billionths of a dollar, so that the order of the answers changes nothing.
#[derive(Debug, Default)]
struct AccountCounts {
    /// The account of the work that this work is a part of.
    whole: Option<CallAccount>,
    answers: AtomicU64,
    unpriced: AtomicU64,
    tokens_in: AtomicU64,
    tokens_out: AtomicU64,
    nano_usd: AtomicU64,
}

/// What an account counted.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AccountTotals {
    /// Answers.
    pub answers: u64,
    /// Those of them with an unknown price.
    pub unpriced: u64,
    /// Tokens that were sent for them.
    pub tokens_in: u64,
    /// Tokens of the answers.
    pub tokens_out: u64,
    /// US dollars; answers without a known price count as 0.
    pub usd: f64,
}

impl CallAccount {
    /// An account of a part of this thread's work: what it counts, the thread's present account counts too.
    #[must_use]
    pub fn of_part() -> Self {
        let whole = ACCOUNT.with_borrow(Clone::clone);
        Self(Arc::new(AccountCounts { whole, ..AccountCounts::default() }))
    }

    /// What was counted so far.
    #[must_use]
    pub fn totals(&self) -> AccountTotals {
        let of = |count: &AtomicU64| count.load(Ordering::Relaxed);
        let AccountCounts { answers, unpriced, tokens_in, tokens_out, nano_usd, .. } = &*self.0;
        AccountTotals {
            answers: of(answers),
            unpriced: of(unpriced),
            tokens_in: of(tokens_in),
            tokens_out: of(tokens_out),
            usd: of(nano_usd) as f64 / 1e9,
        }
    }

    fn count(&self, answer: &CallAnswer) {
        let AccountCounts { whole, answers, unpriced, tokens_in, tokens_out, nano_usd } = &*self.0;
        whole.iter().for_each(|whole| whole.count(answer));
        for (count, more) in [
            (answers, 1),
            (unpriced, u64::from(answer.usd.is_none())),
            (tokens_in, answer.tokens_in),
            (tokens_out, answer.tokens_out),
            (nano_usd, (answer.usd.unwrap_or(0.0).max(0.0) * 1e9).round() as u64),
        ] {
            count.fetch_add(more, Ordering::Relaxed);
        }
    }
}

/// The context of some work: the span that it is a part of, the subscriber that gets the spans, and the purpose of the calls.
#[derive(Debug, Clone)]
pub struct CallContext {
    /// The subscriber and the span; `None` if there is no subscriber.
    watched: Option<(Dispatch, Span)>,
    purpose: Option<&'static str>,
    account: Option<CallAccount>,
}

/// Restores the previous account of the thread when it is dropped, also after a panic.
struct AccountGuard(Option<CallAccount>);

impl Drop for AccountGuard {
    fn drop(&mut self) {
        ACCOUNT.replace(self.0.take());
    }
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
        Self {
            watched: dispatch.map(|dispatch| (dispatch, Span::current())),
            purpose: Self::current_purpose(),
            account: ACCOUNT.with_borrow(Clone::clone),
        }
    }

    /// Runs a function in this context.
    pub fn run_within<T>(&self, work: impl FnOnce() -> T) -> T {
        let _guard = PurposeGuard(PURPOSE.replace(self.purpose));
        let _account = AccountGuard(ACCOUNT.replace(self.account.clone()));
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

    /// Runs a function whose answers an account counts.
    pub fn with_account<T>(account: &CallAccount, work: impl FnOnce() -> T) -> T {
        let _guard = AccountGuard(ACCOUNT.replace(Some(account.clone())));
        work()
    }

    /// Counts an answer in this thread's account, if it has one.
    pub(crate) fn count_answer(answer: &CallAnswer) {
        ACCOUNT.with_borrow(|account| account.iter().for_each(|account| account.count(answer)));
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

    #[test]
    fn an_account_counts_the_answers_of_its_work_in_every_thread() {
        let answer = CallAnswer {
            text: String::new(),
            finish: "stop".to_owned(),
            tokens_in: 10,
            tokens_out: 2,
            usd: Some(0.25),
            latency_ms: 0,
            attempts: 1,
        };
        let account = CallAccount::default();
        CallContext::with_account(&account, || {
            CallContext::count_answer(&answer);
            let context = CallContext::from_current_thread();
            thread::scope(|scope| {
                scope.spawn(|| context.run_within(|| CallContext::count_answer(&answer)));
                scope.spawn(|| CallContext::count_answer(&answer));
            });
        });
        CallContext::count_answer(&answer);
        assert_eq!(account.totals(), AccountTotals { answers: 2, unpriced: 0, tokens_in: 20, tokens_out: 4, usd: 0.5 });
    }

    #[test]
    fn an_account_of_a_part_counts_for_the_whole_too() {
        let answer = |usd: Option<f64>| CallAnswer {
            text: String::new(),
            finish: "stop".to_owned(),
            tokens_in: 10,
            tokens_out: 2,
            usd,
            latency_ms: 0,
            attempts: 1,
        };
        let whole = CallAccount::default();
        let part = CallContext::with_account(&whole, || {
            CallContext::count_answer(&answer(Some(1.0)));
            let part = CallAccount::of_part();
            CallContext::with_account(&part, || CallContext::count_answer(&answer(None)));
            part
        });
        let of_part = AccountTotals { answers: 1, unpriced: 1, tokens_in: 10, tokens_out: 2, usd: 0.0 };
        assert_eq!(part.totals(), of_part);
        assert_eq!(whole.totals(), AccountTotals { answers: 2, unpriced: 1, tokens_in: 20, tokens_out: 4, usd: 1.0 });
        let alone = CallAccount::of_part();
        CallContext::with_account(&alone, || CallContext::count_answer(&answer(None)));
        assert_eq!(whole.totals().answers, 2, "outside of the work it is a part of nothing");
    }
}
