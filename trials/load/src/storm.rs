//! Measures how many calls succeed, and how fast, with a rate-limited provider that often fails.

use crate::{
    calls::{TrialClient, words_request},
    provider::{ProviderProcess, ProviderReport},
};
use std::{collections::BTreeMap, time::Instant};
use wayword_remote::RequestConcurrency;
use wayword_run::{error::CommandError, output::CommandOutput};

/// A slow, partial answer is given up after this time, seconds. Every whole answer takes less.
const TIMEOUT_S: f64 = 3.0;

/// Makes calls against a provider that accepts `per_s` requests per second and fails a `share` of them, and prints how many succeed.
pub(super) fn measure_storm(
    calls: usize,
    per_s: f64,
    burst: u32,
    share: f64,
    seed: u64,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let flags = [
        ("--requests-per-second", per_s.to_string()),
        ("--burst", burst.to_string()),
        ("--storm", share.to_string()),
        ("--seed", seed.to_string()),
        ("--latency-ms", "100".to_owned()),
    ];
    let flags: Vec<String> = flags.into_iter().flat_map(|(name, value)| [name.to_owned(), value]).collect();
    let provider = ProviderProcess::start(&flags)?;
    let client =
        TrialClient::new(&provider.base_url, "server/words", RequestConcurrency::Adaptive { most: 64 }, TIMEOUT_S)?;
    let begun = Instant::now();
    let failed = client.make_calls(calls, words_request);
    let took_s = begun.elapsed().as_secs_f64();
    let report = provider.stop_and_report()?;
    let mut lines = goodput_lines(calls, &failed, took_s, per_s * (1.0 - share));
    let ProviderReport { admitted, faults, rate_limited, .. } = report;
    lines.insert(2, format!("{admitted} requests let in, {faults} faults, {rate_limited} refused by the rate limit"));
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// The answers, compared with the most that are possible per second; then why the others failed.
fn goodput_lines(calls: usize, failed: &[String], took_s: f64, bound_per_s: f64) -> Vec<String> {
    let answered = calls - failed.len();
    let answers_per_s = answered as f64 / took_s;
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for reason in failed {
        *reasons.entry(reason.as_str()).or_default() += 1;
    }
    let share = 100.0 * answers_per_s / bound_per_s;
    let mut lines = vec![
        format!("{calls} calls: {answered} answered, {} failed, in {took_s:.1} s", failed.len()),
        format!("{answers_per_s:.1} answers/s, {share:.1} % of {bound_per_s:.1} (allowed rate x share without fault)"),
    ];
    lines.extend(reasons.into_iter().map(|(reason, count)| format!("  {count} x {reason}")));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 50 requests per second 70 % meet no fault, which makes 35. 3,900 answers in 120 s are 32.5 per second.
    #[test]
    fn goodput_is_the_share_of_answers_in_the_rate_without_faults() {
        let mut failed = vec!["timed out".to_owned(); 60];
        failed.extend(vec!["broken answer".to_owned(); 40]);
        assert_eq!(
            goodput_lines(4000, &failed, 120.0, 50.0 * (1.0 - 0.3)),
            [
                "4000 calls: 3900 answered, 100 failed, in 120.0 s",
                "32.5 answers/s, 92.9 % of 35.0 (allowed rate x share without fault)",
                "  40 x broken answer",
                "  60 x timed out",
            ]
        );
    }
}
