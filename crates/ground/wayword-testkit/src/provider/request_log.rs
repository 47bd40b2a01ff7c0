//! Counts of requests, answers and faults, with which tests check that a client repeats and bills what it should.

use super::ServiceFault;
use std::collections::BTreeMap;

/// The counts of a provider so far.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProviderLog {
    /// Requests that came, refused ones too.
    pub received: u64,
    /// Requests that were let in: neither their key nor the rate was a reason to refuse them.
    /// `FaultSchedule::key_refused_after` and `FaultSchedule::quota_after` count these.
    pub admitted: u64,
    /// Requests that got a whole answer. A real service would bill these.
    pub answered: u64,
    /// Requests above the rate.
    pub rate_limited: u64,
    /// Requests without the right key, or after it was withdrawn.
    pub key_refused: u64,
    /// Requests after the quota was used up.
    pub out_of_quota: u64,
    /// Requests that are malformed, or name an unknown model.
    pub unfit: u64,
    /// How often each fault was committed.
    pub faults: BTreeMap<ServiceFault, u64>,
    /// The highest number of requests that were in work at the same time.
    pub most_at_once: u64,
    /// The length of the longest chain of requests in which each came after the one before had ended: how often a client
    /// waited, however many requests it sent at a time. This does not depend on the speed of the machine, as long as requests
    /// that are sent together arrive within the latency.
    pub rounds: u64,
    /// Each distinct request (its dialect, model and body), by hash.
    pub bodies: BTreeMap<u64, RequestCounts>,
    /// Requests that are in work now.
    pub(super) at_once: u64,
}

/// How often one request came, was let in and was answered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RequestCounts {
    /// Times that it came.
    pub received: u32,
    /// Times that it was let in.
    pub admitted: u32,
    /// Times that it got a whole answer.
    pub answered: u32,
}

impl ProviderLog {
    /// Answers beyond the first to the same request, which had to be paid again.
    #[must_use]
    pub fn answered_again(&self) -> u64 {
        self.bodies.values().map(|body| u64::from(body.answered.saturating_sub(1))).sum()
    }

    /// Distinct requests that got an answer.
    #[must_use]
    pub fn distinct_answered(&self) -> u64 {
        self.bodies.values().filter(|body| body.answered > 0).count() as u64
    }

    /// The number of all faults that were committed.
    #[must_use]
    pub fn faults_committed(&self) -> u64 {
        self.faults.values().sum()
    }

    /// Counts a request that came, and returns its round: one more than the latest round that has ended.
    pub(super) fn count_arrival(&mut self, request: u64) -> u64 {
        self.received += 1;
        self.at_once += 1;
        self.most_at_once = self.most_at_once.max(self.at_once);
        self.bodies.entry(request).or_default().received += 1;
        self.rounds + 1
    }

    /// Counts the end of a request of a round.
    pub(super) fn finish_round(&mut self, round: u64) {
        self.at_once -= 1;
        self.rounds = self.rounds.max(round);
    }

    /// Counts a request that is let in. Returns how many were let in before it, and how many of them were equal to it.
    pub(super) fn count_admission(&mut self, request: u64) -> (u64, u64) {
        let body = self.bodies.entry(request).or_default();
        let before = (self.admitted, u64::from(body.admitted));
        self.admitted += 1;
        body.admitted += 1;
        before
    }

    /// Counts a request that got a whole answer.
    pub(super) fn count_answer(&mut self, request: u64) {
        self.answered += 1;
        self.bodies.entry(request).or_default().answered += 1;
    }
}
