//! The faults that the provider can commit, and the draw that decides which request gets which fault.

use super::RetryAfter;
use rand::Rng;
use std::time::Duration;

/// What can go wrong with one request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ServiceFault {
    /// 429 although the client kept to the rate.
    TooMany(RetryAfter),
    /// 500.
    Server,
    /// 502 with a page of HTML, as gateways send it.
    Gateway,
    /// 503.
    Unavailable,
    /// 529: overloaded.
    Overloaded,
    /// The head and half of the body, then a TCP reset.
    Reset,
    /// The connection is closed before any byte of a response.
    Closed,
    /// The body comes a byte at a time, with [`FaultSchedule::trickle`] between two bytes.
    Trickle,
    /// Half of the JSON, with a `content-length` that matches the half, so that HTTP looks complete.
    Truncated,
    /// A reply without a choice in it.
    NoChoices,
    /// 200 with an error in the body.
    ErrorInOk,
    /// 200 with a page of HTML.
    WrongType,
    /// 500 with a message that repeats the key of the request.
    EchoesKey,
    /// Half of the answer, marked as cut off for its length.
    CutOff,
    /// The service's filter withholds the answer.
    Filtered,
    /// The model refuses.
    Refused,
    /// A body of JSON that never ends.
    Endless,
}

/// Which faults occur, and how often.
///
/// A fault is drawn from the seed, the request (its dialect, model and body) and the number of equal requests that were
/// let in before. So the same requests get the same faults in every run, in any order, and a repeated request may
/// succeed.
#[derive(Debug, Clone)]
pub struct FaultSchedule {
    /// Each fault with its share of the requests, 0 to 1.
    shares: Vec<(ServiceFault, f64)>,
    /// The faults of the first requests, in order; `None` for a request without a fault.
    first: Vec<Option<ServiceFault>>,
    /// After this number of requests was let in, the key is refused (401).
    pub key_refused_after: Option<u64>,
    /// After this number of requests was let in, the account is empty.
    pub quota_after: Option<u64>,
    /// The wait that [`ServiceFault::TooMany`] asks for. Forms in whole seconds round it up.
    pub wait: Duration,
    /// The time between two bytes of [`ServiceFault::Trickle`].
    pub trickle: Duration,
}

impl Default for FaultSchedule {
    fn default() -> Self {
        Self {
            shares: Vec::new(),
            first: Vec::new(),
            key_refused_after: None,
            quota_after: None,
            wait: Duration::from_millis(50),
            trickle: Duration::from_millis(200),
        }
    }
}

/// The faults after which the same request may succeed, except 429, which has several forms.
const PASSING_FAULTS: [ServiceFault; 12] = [
    ServiceFault::Server,
    ServiceFault::Gateway,
    ServiceFault::Unavailable,
    ServiceFault::Overloaded,
    ServiceFault::Reset,
    ServiceFault::Closed,
    ServiceFault::Trickle,
    ServiceFault::Truncated,
    ServiceFault::NoChoices,
    ServiceFault::ErrorInOk,
    ServiceFault::WrongType,
    ServiceFault::EchoesKey,
];

impl FaultSchedule {
    /// All faults after which the same request may succeed, equally often, together at `share` (0 to 1) of the
    /// requests. There are thirteen: 500, 502, 503, 529, reset, closed, trickle, truncated, no choices, error under 200, wrong
    /// type, echoed key, and 429. The forms of 429 divide its part among themselves.
    #[must_use]
    pub fn storm(share: f64) -> Self {
        let each = share / (PASSING_FAULTS.len() + 1) as f64;
        let each_form = each / RetryAfter::ALL.len() as f64;
        let rate_faults = RetryAfter::ALL.iter().map(|form| (ServiceFault::TooMany(*form), each_form));
        let shares = PASSING_FAULTS.iter().map(|fault| (*fault, each)).chain(rate_faults).collect();
        Self { shares, ..Self::default() }
    }

    /// The same with one more fault, at a share (0 to 1) of all requests.
    #[must_use]
    pub fn with_fault(mut self, fault: ServiceFault, share: f64) -> Self {
        self.shares.push((fault, share));
        self
    }

    /// The same, but the first requests that are let in get these faults, in order.
    #[must_use]
    pub fn with_first_faults(mut self, faults: &[Option<ServiceFault>]) -> Self {
        self.first = faults.to_vec();
        self
    }

    /// The share of requests that get no drawn fault.
    #[must_use]
    pub fn free_share(&self) -> f64 {
        (1.0 - self.shares.iter().map(|(_, share)| share).sum::<f64>()).max(0.0)
    }

    /// The fault of a request, if it gets one. `request` is its hash; `index` requests were let in before it, `nth` of them equal to it.
    pub(super) fn for_request(&self, seed: u64, index: u64, request: u64, nth: u64) -> Option<ServiceFault> {
        if let Some(scripted) = usize::try_from(index).ok().and_then(|index| self.first.get(index)) {
            return *scripted;
        }
        let purpose = ["fault", &format!("{request:016x}"), &nth.to_string()];
        // A draw between 0 and 1 falls into the share of one fault, or beyond all shares.
        let mut rest: f64 = wayword_core::seeded_rng(seed, &purpose).random();
        self.shares.iter().find_map(|(fault, share)| {
            rest -= share;
            (rest < 0.0).then_some(*fault)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn faults_come_at_their_shares_and_the_same_each_time() {
        let faults = FaultSchedule::storm(0.3).with_fault(ServiceFault::Filtered, 0.1);
        let draw = || (0..20_000).map(|request| faults.for_request(7, 0, request, 0)).collect::<Vec<_>>();
        let drawn = draw();
        assert_eq!(drawn, draw());
        let mut counts: BTreeMap<Option<ServiceFault>, i32> = BTreeMap::new();
        drawn.iter().for_each(|fault| *counts.entry(*fault).or_default() += 1);
        assert!((counts[&None] - 12_000).abs() < 300, "{counts:?}");
        assert!((counts[&Some(ServiceFault::Filtered)] - 2_000).abs() < 200, "{counts:?}");
        assert!((counts[&Some(ServiceFault::Reset)] - 461).abs() < 100, "{counts:?}");
        let many = RetryAfter::ALL.iter().map(|form| counts[&Some(ServiceFault::TooMany(*form))]).sum::<i32>();
        assert!((many - 461).abs() < 100, "{counts:?}");
        assert!((faults.free_share() - 0.6).abs() < 1e-9);
    }

    #[test]
    fn a_request_that_is_repeated_gets_through() {
        let faults = FaultSchedule::storm(0.5);
        let attempts = |request| (0..64).position(|nth| faults.for_request(1, 0, request, nth).is_none());
        let needed: Vec<usize> = (0..500).map(|request| attempts(request).unwrap()).collect();
        let mean = needed.iter().sum::<usize>() as f64 / 500.0;
        assert!((0.8..1.2).contains(&mean), "half fail, so one more attempt is needed on average, not {mean}");
    }

    #[test]
    fn a_list_of_faults_comes_first() {
        let faults = FaultSchedule::default().with_first_faults(&[Some(ServiceFault::Reset), None]);
        assert_eq!([0, 1, 2].map(|index| faults.for_request(0, index, 9, 0)), [Some(ServiceFault::Reset), None, None]);
    }
}
