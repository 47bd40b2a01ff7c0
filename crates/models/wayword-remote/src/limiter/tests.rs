use super::{
    gate::{RecentShare, RequestGate},
    *,
};
use crate::{RequestConcurrency, faults::ServiceLoad};
use std::collections::BinaryHeap;

fn rules(concurrency: RequestConcurrency) -> LimiterRules {
    LimiterRules { concurrency, requests_per_minute: None, tokens_per_minute: None }
}

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

#[test]
fn a_fixed_limit_stays() {
    let start = Instant::now();
    let mut gate = RequestGate::new(rules(RequestConcurrency::Fixed(2)), start);
    assert_eq!(gate.next_turn(start), GateTurn::Now);
    gate.note_sent(start, 0);
    assert_eq!(gate.next_turn(start), GateTurn::Now);
    let ticket = gate.note_sent(start, 0);
    assert_eq!(gate.next_turn(start), GateTurn::WhenOneIsBack);
    gate.note_ended(ticket, start + ms(200), RequestOutcome::Burdened { load: ServiceLoad::Over, after: None });
    assert_eq!(gate.next_turn(start + ms(200)), GateTurn::Now);
    gate.note_sent(start + ms(200), 0);
    assert_eq!(gate.next_turn(start + ms(900)), GateTurn::WhenOneIsBack);
}

#[test]
fn a_pause_delays_every_request() {
    let start = Instant::now();
    let mut gate = RequestGate::new(rules(RequestConcurrency::Fixed(4)), start);
    let ticket = gate.note_sent(start, 0);
    gate.note_ended(
        ticket,
        start + ms(50),
        RequestOutcome::Burdened { load: ServiceLoad::Over, after: Some(ms(1000)) },
    );
    assert_eq!(gate.next_turn(start + ms(60)), GateTurn::In(ms(990)));
    assert_eq!(gate.next_turn(start + ms(1050)), GateTurn::Now);
}

#[test]
fn a_refusal_among_many_answers_delays_no_other_request() {
    let start = Instant::now();
    let mut gate = RequestGate::new(rules(RequestConcurrency::Fixed(4)), start);
    let mut now = start;
    let mut meet = |gate: &mut RequestGate, outcome: RequestOutcome| {
        now += ms(10);
        let ticket = gate.note_sent(now, 0);
        gate.note_ended(ticket, now, outcome);
        gate.next_turn(now)
    };
    let refused = RequestOutcome::Burdened { load: ServiceLoad::Over, after: Some(ms(1000)) };
    for _ in 0..50 {
        meet(&mut gate, RequestOutcome::Answered { tokens: 1 });
    }
    assert_eq!(meet(&mut gate, refused), GateTurn::Now);
    // Several refusals in a row are not chance.
    assert!((0..10).any(|_| meet(&mut gate, refused) == GateTurn::In(ms(1000))));
}

#[test]
fn an_adaptive_limit_grows_shrinks_once_and_ignores_chance() {
    let start = Instant::now();
    let mut gate = RequestGate::new(rules(RequestConcurrency::Adaptive { most: 16 }), start);
    let mut now = start;
    // Sends every request that may be sent, and ends all with the same outcome.
    let mut round = |gate: &mut RequestGate, outcome: RequestOutcome| {
        let mut out = Vec::new();
        while gate.next_turn(now) == GateTurn::Now {
            out.push(gate.note_sent(now, 0));
        }
        now += ms(200);
        out.into_iter().for_each(|ticket| gate.note_ended(ticket, now, outcome));
        now += ms(200);
    };
    for _ in 0..40 {
        round(&mut gate, RequestOutcome::Answered { tokens: 1 });
    }
    assert_eq!(gate.limit(), 16.0);
    round(&mut gate, RequestOutcome::Failed);
    assert_eq!(gate.limit(), 16.0);
    round(&mut gate, RequestOutcome::Burdened { load: ServiceLoad::Slow, after: None });
    assert!((gate.limit() - 11.2).abs() < 1e-9, "{}", gate.limit());
    // The limit never goes below one.
    for _ in 0..100 {
        round(&mut gate, RequestOutcome::Burdened { load: ServiceLoad::Slow, after: None });
    }
    assert_eq!(gate.limit(), 1.0);
}

#[test]
fn gate_enforces_rates_of_requests_and_tokens() {
    let start = Instant::now();
    let minute = |rules: LimiterRules, tokens: u64| {
        let mut gate = RequestGate::new(rules, start);
        let (mut now, mut left) = (start, 0);
        while now < start + Duration::from_secs(60) {
            match gate.next_turn(now) {
                GateTurn::Now => {
                    let ticket = gate.note_sent(now, tokens);
                    gate.note_ended(ticket, now, RequestOutcome::Answered { tokens });
                    left += 1;
                }
                GateTurn::In(wait) => now += wait.max(ms(1)),
                GateTurn::WhenOneIsBack => unreachable!(),
            }
        }
        left
    };
    let fixed = rules(RequestConcurrency::Fixed(9));
    let requests = minute(LimiterRules { requests_per_minute: Some(120.0), ..fixed }, 1);
    assert!((120..=124).contains(&requests), "{requests}");
    let tokens = minute(LimiterRules { tokens_per_minute: Some(60_000.0), ..fixed }, 500);
    assert!((120..=125).contains(&tokens), "{tokens}");
    // A request larger than the bucket is sent nevertheless, and later requests wait longer.
    let large = minute(LimiterRules { tokens_per_minute: Some(60_000.0), ..fixed }, 30_000);
    assert!((2..=3).contains(&large), "{large}");
}

#[test]
fn the_smaller_of_the_users_and_the_services_limit_counts() {
    let start = Instant::now();
    let own = LimiterRules { requests_per_minute: Some(60.0), ..rules(RequestConcurrency::Fixed(9)) };
    for (told, expected) in [(30.0, 2000), (600.0, 1000)] {
        let mut gate = RequestGate::new(own, start);
        gate.adopt_limits(AdvertisedLimits { requests_per_minute: Some(told), tokens_per_minute: None }, start);
        while gate.next_turn(start) == GateTurn::Now {
            gate.note_sent(start, 0);
        }
        assert_eq!(gate.next_turn(start), GateTurn::In(ms(expected)), "{told}");
    }
}

/// A service that accepts a number of requests per second, and refuses the others. Of the accepted ones, some fail,
/// some are refused nevertheless, and some are never answered.
struct Storm {
    per_s: f64,
    burst: f64,
    retry_after: Duration,
    faults: f64,
    whims: f64,
    lost: f64,
    latency: Duration,
}

/// Timeout of a request that is never answered.
const TIMEOUT: Duration = Duration::from_secs(3);

/// How a request ends.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    Answered,
    Failed,
    Whim,
    Lost,
    Refused,
}

impl Storm {
    /// The fate of an accepted request, from a random number from 0 to 1.
    fn fate(&self, chance: f64) -> Fate {
        let fates = [(Fate::Failed, self.faults), (Fate::Whim, self.whims), (Fate::Lost, self.lost)];
        let mut left = chance;
        let met = fates.into_iter().find(|(_, share)| {
            left -= share;
            left < 0.0
        });
        met.map_or(Fate::Answered, |(fate, _)| fate)
    }
}

/// Answered requests per second in a run of `seconds`, and how many were refused.
fn goodput(storm: &Storm, concurrency: RequestConcurrency, seconds: u64) -> (f64, u32) {
    let start = Instant::now();
    let end = start + Duration::from_secs(seconds);
    let mut gate = RequestGate::new(rules(concurrency), start);
    let (mut level, mut filled, mut answered, mut refused, mut drawn) = (storm.burst, start, 0, 0, 0_u64);
    // Requests in flight by the time at which they end, the earliest first.
    let mut out: BinaryHeap<std::cmp::Reverse<(Instant, usize, Fate)>> = BinaryHeap::new();
    let mut tickets = Vec::new();
    let mut now = start;
    while now < end {
        let wait = match gate.next_turn(now) {
            GateTurn::Now => {
                level = (level + (now - filled).as_secs_f64() * storm.per_s).min(storm.burst);
                filled = now;
                drawn += 1;
                let chance =
                    wayword_core::seed::derive_seed(drawn, &["storm"]).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11;
                let fate = if level < 1.0 { Fate::Refused } else { storm.fate(chance as f64 / (1_u64 << 53) as f64) };
                level -= if fate == Fate::Refused { 0.0 } else { 1.0 };
                let latency = match fate {
                    // Refusals come back at once.
                    Fate::Refused => ms(5),
                    Fate::Lost => TIMEOUT,
                    Fate::Answered | Fate::Failed | Fate::Whim => storm.latency,
                };
                out.push(std::cmp::Reverse((now + latency, tickets.len(), fate)));
                tickets.push(gate.note_sent(now, 0));
                continue;
            }
            GateTurn::In(wait) => Some(now + wait.max(Duration::from_micros(50))),
            GateTurn::WhenOneIsBack => None,
        };
        let back = out.peek().map(|next| next.0.0);
        now = wait.into_iter().chain(back).min().unwrap();
        while let Some(&std::cmp::Reverse((at, ticket, fate))) = out.peek().filter(|next| next.0.0 <= now) {
            out.pop();
            let outcome = match fate {
                Fate::Answered => RequestOutcome::Answered { tokens: 1 },
                Fate::Failed => RequestOutcome::Failed,
                Fate::Lost => RequestOutcome::Burdened { load: ServiceLoad::Slow, after: None },
                Fate::Whim | Fate::Refused => {
                    RequestOutcome::Burdened { load: ServiceLoad::Over, after: Some(storm.retry_after) }
                }
            };
            answered += u32::from(fate == Fate::Answered);
            refused += u32::from(fate == Fate::Refused);
            gate.note_ended(tickets[ticket], at, outcome);
        }
    }
    (f64::from(answered) / seconds as f64, refused)
}

#[test]
fn gate_reaches_most_of_an_unknown_rate_in_a_storm() {
    for (per_s, burst, retry_after) in [
        (50.0, 3.0, 1000),
        (50.0, 10.0, 1000),
        (50.0, 50.0, 1000),
        (100.0, 20.0, 500),
        (20.0, 5.0, 1000),
        (10.0, 10.0, 1000),
    ] {
        for (faults, whims, lost) in [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.23, 0.045, 0.025)] {
            let storm = Storm { per_s, burst, retry_after: ms(retry_after), faults, whims, lost, latency: ms(200) };
            for concurrency in [RequestConcurrency::Adaptive { most: 64 }, RequestConcurrency::Fixed(64)] {
                let (goodput, refused) = goodput(&storm, concurrency, 120);
                let share = goodput / (per_s * (1.0 - faults - whims - lost));
                assert!(
                    share > 0.8,
                    "{per_s}/s, burst {burst}, {whims} whims, {concurrency:?}: {share:.2}, {refused} refused"
                );
            }
        }
    }
}

#[test]
fn refused_ignores_a_pace_that_was_never_tried() {
    let start = Instant::now();
    let mut gate = RequestGate::new(rules(RequestConcurrency::Fixed(64)), start);
    let mut now = start;
    // Ten requests a second for `seconds`, and then ten refusals, too many for chance.
    let mut ten_a_second = |gate: &mut RequestGate, seconds: u64| {
        for _ in 0..10 * seconds {
            now += ms(100);
            assert_eq!(gate.next_turn(now), GateTurn::Now);
            let ticket = gate.note_sent(now, 0);
            gate.note_ended(ticket, now + ms(20), RequestOutcome::Answered { tokens: 1 });
        }
        for _ in 0..10 {
            now += ms(100);
            let ticket = gate.note_sent(now, 0);
            gate.note_ended(ticket, now + ms(20), RequestOutcome::Burdened { load: ServiceLoad::Over, after: None });
        }
        now
    };
    ten_a_second(&mut gate, 60);
    // In a day the learned pace grows without a limit. The next refusal brings it back at once.
    let refused_at = ten_a_second(&mut gate, 86_400);
    gate.next_turn(refused_at + ms(100));
    gate.note_sent(refused_at + ms(100), 0);
    let turn = gate.next_turn(refused_at + ms(100));
    assert!(matches!(turn, GateTurn::In(wait) if wait > ms(60)), "{turn:?}");
}

#[test]
fn faults_without_load_do_not_slow_requests() {
    let storm =
        Storm { per_s: 1e6, burst: 1e6, retry_after: ms(0), faults: 0.3, whims: 0.0, lost: 0.0, latency: ms(200) };
    let (goodput, _) = goodput(&storm, RequestConcurrency::Adaptive { most: 64 }, 60);
    let share = goodput / (64.0 / 0.2 * 0.7);
    assert!(share > 0.9, "{share:.2}");
}

#[test]
fn a_thread_that_waits_gives_up_when_the_run_is_stopped() {
    let limiter = EndpointLimiter::new(rules(RequestConcurrency::Fixed(1)));
    let stopped = std::sync::atomic::AtomicBool::new(false);
    let held = limiter.wait_for_permit(1, || false).unwrap();
    std::thread::scope(|scope| {
        let enter = || limiter.wait_for_permit(1, || stopped.load(std::sync::atomic::Ordering::Relaxed)).is_none();
        let waiting: Vec<_> = (0..8).map(|_| scope.spawn(enter)).collect();
        stopped.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(waiting.into_iter().all(|thread| thread.join().unwrap()));
    });
    held.end_with(RequestOutcome::Failed);
    assert!(limiter.wait_for_permit(1, || false).is_some());
}

#[test]
fn no_more_are_out_than_the_limit() {
    use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
    let limiter = EndpointLimiter::new(rules(RequestConcurrency::Fixed(3)));
    let (out, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..12 {
            scope.spawn(|| {
                for _ in 0..20 {
                    let permit = limiter.wait_for_permit(1, || false).unwrap();
                    most.fetch_max(out.fetch_add(1, SeqCst) + 1, SeqCst);
                    std::thread::sleep(Duration::from_micros(200));
                    out.fetch_sub(1, SeqCst);
                    permit.end_with(RequestOutcome::Answered { tokens: 1 });
                }
            });
        }
    });
    assert_eq!(most.load(SeqCst), 3);
}

#[test]
fn share_counts_the_first_fully_and_old_ones_hardly() {
    let mut share = RecentShare::default();
    assert_eq!(share.count_request(true), 1.0);
    let after_calm = (0..400).fold(1.0, |_, _| share.count_request(false));
    assert!(after_calm < 0.01, "{after_calm}");
    assert!((0.01..0.03).contains(&share.count_request(true)));
    let after_storm = (0..400).fold(0.0, |_, _| share.count_request(true));
    assert!(after_storm > 0.99, "{after_storm}");
}
