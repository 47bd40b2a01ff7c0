//! One rate for each provider, for all programs together.
//!
//! For each provider the database keeps the time at which the next request is due. A request takes that time for itself and moves it
//! forward, by its size (one request, or its tokens) divided by the rate. So requests leave in the order in which they asked. This is
//! the algorithm GCRA, in the form of a virtual schedule.

use super::link::DatabaseLink;
use crate::{LedgerError, ProviderRates, store::SendSlot};
use std::time::{Duration, Instant};

/// Burst: how much may be sent above the rate in any second, as seconds of the rate. At 0.1, 20 requests a second may be 22.
const BURST_S: f64 = 0.1;

/// Smallest burst, requests: a rate below 10 a second may be exceeded by one request, although a tenth of it is less.
const MIN_BURST_REQUESTS: f64 = 1.0;

/// Takes a turn at provider `$1`. `$2` and `$3` are the `takes_s` of its requests and tokens, `$4` and `$5` the `early_s`. Selects
/// how long to wait, seconds; the later of the two rates decides.
///
/// It is not synced to disk: the time of the next request need not survive a crash of the server, because a restart takes longer
/// than a burst.
const TAKE_TURN_SQL: &str = "
UPDATE wayword_ledger.rates
SET requests = greatest(requests, clock_timestamp()) + make_interval(secs => $2),
    tokens = greatest(tokens, clock_timestamp()) + make_interval(secs => $3)
WHERE provider = $1 AND set_config('synchronous_commit', 'off', true) = 'off'
RETURNING extract(epoch FROM greatest(
    requests - make_interval(secs => $2) - make_interval(secs => $4),
    tokens - make_interval(secs => $3) - make_interval(secs => $5)
) - clock_timestamp())::float8";

/// Makes the row of a new provider.
const NEW_RATE_SQL: &str = "
INSERT INTO wayword_ledger.rates (provider, requests, tokens) VALUES ($1, clock_timestamp(), clock_timestamp())
ON CONFLICT DO NOTHING";

/// The timing of a request under one rate, seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct RateShare {
    /// How far this request moves the time at which the next one is due.
    takes_s: f64,
    /// How much earlier than due it may leave, about half of the burst.
    early_s: f64,
    /// How much later than due it may leave, the other half.
    late_s: f64,
}

impl RateShare {
    /// `per_s` is the rate, `amount` the size of the request, and `least` the smallest burst, all in requests or all in tokens.
    /// `None` if there is no rate to keep.
    fn from_rate(per_s: Option<f64>, amount: f64, least: f64) -> Option<Self> {
        let per_s = per_s.filter(|per_s| per_s.is_finite() && *per_s > 0.0)?;
        let half = (per_s * BURST_S).max(least) / 2.0;
        // The request itself counts in every second.
        let early_s = (half - least).max(0.0) / per_s;
        Some(Self { takes_s: amount / per_s, early_s, late_s: half / per_s })
    }
}

/// Takes the next time at which a request is due.
pub(super) fn take_turn(
    link: &DatabaseLink,
    provider: &str,
    rates: ProviderRates,
    tokens: u64,
) -> Result<Option<SendSlot>, LedgerError> {
    let requests = RateShare::from_rate(rates.requests_per_s, 1.0, MIN_BURST_REQUESTS);
    let tokens = RateShare::from_rate(rates.tokens_per_s, tokens as f64, 0.0);
    let Some(late_s) = requests.iter().chain(&tokens).map(|share| share.late_s).reduce(f64::min) else {
        return Ok(None);
    };
    let (requests, tokens) = (requests.unwrap_or_default(), tokens.unwrap_or_default());
    let late = Duration::try_from_secs_f64(late_s).unwrap_or_default();
    loop {
        let taken = link.pool.with_connection("take a turn", |connection| {
            let asked = Instant::now();
            let rows = connection.query_rows(
                TAKE_TURN_SQL,
                &[&provider, &requests.takes_s, &tokens.takes_s, &requests.early_s, &tokens.early_s],
            )?;
            let heard = Instant::now();
            rows.first().map(|row| row.try_get::<_, f64>(0).map(|wait_s| (asked, heard, wait_s))).transpose()
        })?;
        let Some((asked, heard, wait_s)) = taken else {
            link.query_rows("begin a rate", NEW_RATE_SQL, &[&provider])?;
            continue;
        };
        let wait = Duration::try_from_secs_f64(wait_s.max(0.0)).unwrap_or(Duration::MAX);
        // The database looked at its clock between the question and the answer.
        let (from, until) = (heard.checked_add(wait), asked.checked_add(wait).and_then(|due| due.checked_add(late)));
        return Ok(from.zip(until).map(|(from, until)| SendSlot { from, until }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_no_second_more_than_the_rate_and_a_burst_leave() {
        for per_s in [0.5, 1.0, 7.0, 20.0, 60.0, 200.0, 3000.0] {
            let share = RateShare::from_rate(Some(per_s), 1.0, MIN_BURST_REQUESTS).unwrap();
            let most = (per_s * (1.0 + share.early_s + share.late_s)).ceil();
            assert!(most <= (per_s + (per_s * BURST_S).max(MIN_BURST_REQUESTS)).ceil(), "{per_s}: {most}");
        }
        assert_eq!([None, Some(0.0), Some(f64::NAN)].map(|per_s| RateShare::from_rate(per_s, 1.0, 1.0)), [None; 3]);
    }
}
