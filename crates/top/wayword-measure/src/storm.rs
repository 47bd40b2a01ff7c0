//! A rate-limited provider in a storm: how much gets through.

use crate::{
    calls::{Client, words},
    provider::Process,
};
use std::{collections::BTreeMap, time::Instant};
use wayword::{error::Error, output::Output};
use wayword_remote::Concurrency;

/// What a trickling answer costs: longer than any that is whole takes.
const TIMEOUT_S: f64 = 3.0;

pub(super) fn measure(
    calls: usize,
    per_s: f64,
    burst: u32,
    share: f64,
    seed: u64,
    output: &Output,
) -> Result<(), Error> {
    let flags = [
        ("--requests-per-second", per_s.to_string()),
        ("--burst", burst.to_string()),
        ("--storm", share.to_string()),
        ("--seed", seed.to_string()),
        ("--latency-ms", "100".to_owned()),
    ];
    let flags: Vec<String> = flags.into_iter().flat_map(|(name, value)| [name.to_owned(), value]).collect();
    let provider = Process::start(&flags)?;
    let client = Client::new(&provider.base_url, "server/words", Concurrency::Adaptive { most: 64 }, TIMEOUT_S)?;
    let begun = Instant::now();
    let failed = client.make(calls, words);
    let took_s = begun.elapsed().as_secs_f64();
    let told = provider.end()?;
    let bound = per_s * (1.0 - share);
    let good = (calls - failed.len()) as f64 / took_s;
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for reason in &failed {
        *reasons.entry(reason.as_str()).or_default() += 1;
    }
    let mut lines = vec![
        format!("{calls} calls: {} answered, {} failed, in {took_s:.1} s", calls - failed.len(), failed.len()),
        format!(
            "{good:.1} answers/s, {:.1} % of {bound:.1} (allowed rate x share without fault)",
            100.0 * good / bound
        ),
        format!("{} requests let in, {} faults, {} refused by the rate", told.admitted, told.faults, told.rate_limited),
    ];
    lines.extend(reasons.into_iter().map(|(reason, count)| format!("  {count} x {reason}")));
    output.data(&(), lines.join("\n"));
    Ok(())
}
