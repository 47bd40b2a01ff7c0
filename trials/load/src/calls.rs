//! Measures calls per second, and this program's own processor time and memory for them.

use crate::provider::ProviderProcess;
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use tempfile::TempDir;
use wayword_core::{ChatMessage, Image, LanguageModel, ModelRequest, SamplingOptions};
use wayword_ledger::{Ledger, RunLimits};
use wayword_remote::{ModelServices, RemoteConfig, RemoteModel, RequestConcurrency};
use wayword_run::{error::CommandError, output::CommandOutput};
use wayword_testkit::resources;

/// A model of a provider, with a ledger in a temporary folder.
pub(super) struct TrialClient {
    pub(super) model: Arc<RemoteModel>,
    concurrency: RequestConcurrency,
    _folder: TempDir,
}

impl TrialClient {
    pub(super) fn new(
        base_url: &str,
        model: &str,
        concurrency: RequestConcurrency,
        timeout_s: f64,
    ) -> Result<Self, CommandError> {
        let folder = tempfile::tempdir().map_err(|source| CommandError::Io {
            path: std::env::temp_dir(),
            doing: "put a ledger into",
            source,
        })?;
        let run = Ledger::open(&folder.path().join("ledger.db"))?.start_run("measure", RunLimits::default())?;
        let config =
            RemoteConfig { base_url: Some(base_url.to_owned()), concurrency, timeout_s, ..RemoteConfig::default() };
        Ok(Self { model: ModelServices::new(config, run)?.model(model)?, concurrency, _folder: folder })
    }

    /// Makes `calls` calls with requests that `request` builds from the call's number. Returns the errors of the calls that failed.
    pub(super) fn make_calls(&self, calls: usize, request: impl Fn(usize) -> ModelRequest + Sync) -> Vec<String> {
        let next = AtomicUsize::new(0);
        let failed: Mutex<Vec<String>> = Mutex::default();
        thread::scope(|scope| {
            for _ in 0..self.concurrency.thread_count() {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= calls {
                            break;
                        }
                        for error in
                            self.model.complete_requests(&[request(number)]).into_iter().filter_map(Result::err)
                        {
                            failed.lock().unwrap_or_else(PoisonError::into_inner).push(error.to_string());
                        }
                    }
                });
            }
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A request with a prompt of about a hundred words, different for each number.
pub(super) fn words_request(number: usize) -> ModelRequest {
    build_request(ChatMessage::from_user(format!(
        "Question {number}. {}",
        "What is to be seen on the left of the room? ".repeat(10)
    )))
}

fn build_request(message: ChatMessage) -> ModelRequest {
    let sampling = SamplingOptions { temperature: 0.0, max_tokens: 60, seed: 0 };
    ModelRequest { messages: vec![message], sampling, replicate: 0, schema: None, tools: &[] }
}

/// The memory is measured after these numbers of calls.
const MEMORY_CHECK_CALLS: [usize; 3] = [1_000, 10_000, 100_000];

/// Makes calls against a provider that takes `latency_ms` for each, and prints their rate, processor time and memory.
pub(super) fn measure_calls(
    calls: usize,
    latency_ms: u64,
    concurrency: usize,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let provider = ProviderProcess::start(&["--latency-ms".to_owned(), latency_ms.to_string()])?;
    let client = TrialClient::new(&provider.base_url, "server/words", RequestConcurrency::Fixed(concurrency), 30.0)?;
    // Connections and threads are made once, so they are made before the measurement. No measured call has such a high number.
    client.make_calls(concurrency, |number| words_request(usize::MAX / 2 + number));
    let (begun, time_before) = (Instant::now(), resources::processor_time());
    let mut done = 0;
    let mut lines = Vec::new();
    for until in MEMORY_CHECK_CALLS.into_iter().filter(|count| *count < calls).chain([calls]) {
        let failed = client.make_calls(until - done, |number| words_request(done + number));
        done = until;
        lines.push(format!(
            "after {until} calls: {:.1} MiB resident, {} failed",
            resources::resident_mib(),
            failed.len()
        ));
    }
    let took = begun.elapsed();
    lines.push(describe_throughput(calls, took, latency_ms, concurrency));
    lines.push(format!(
        "{} of this program's processor time per call",
        per_call(resources::processor_time() - time_before, calls)
    ));
    provider.stop_and_report()?;
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// Calls per second, and their share of the most that is possible with this latency and concurrency.
fn describe_throughput(calls: usize, took: Duration, latency_ms: u64, concurrency: usize) -> String {
    let per_s = calls as f64 / took.as_secs_f64();
    if latency_ms == 0 {
        return format!("{per_s:.1} calls/s");
    }
    let ideal = concurrency as f64 * 1e3 / latency_ms as f64;
    format!("{per_s:.1} calls/s, {:.1} % of the ideal {ideal:.1}", 100.0 * per_s / ideal)
}

/// The time of one call, as text.
fn per_call(time: Duration, calls: usize) -> String {
    format!("{:.2} ms", time.as_secs_f64() * 1e3 / calls as f64)
}

/// Makes calls with pictures, each asked about once and then ten times, and prints the processor time per call.
pub(super) fn measure_pictures(calls: usize, output: &CommandOutput) -> Result<(), CommandError> {
    let provider = ProviderProcess::start(&[])?;
    let mut lines = Vec::new();
    for (calls_per_picture, title) in [(1, "each picture asked about once"), (10, "each picture asked about ten times")]
    {
        let client = TrialClient::new(&provider.base_url, "server/eye", RequestConcurrency::Fixed(8), 30.0)?;
        let images: Vec<Arc<Image>> = (0..calls / calls_per_picture)
            .filter_map(|number| noise_picture(number + calls_per_picture).ok().map(Arc::new))
            .collect();
        let time_before = resources::processor_time();
        let failed = client.make_calls(calls, |number| {
            let image = images.get(number / calls_per_picture).cloned().into_iter().collect();
            build_request(ChatMessage::about_images(format!("Question: what is {number}?\nAnswer:"), image))
        });
        let spent: Duration = resources::processor_time() - time_before;
        lines.push(format!(
            "{title} (640 x 480): {} of this program's processor time per call, {} failed",
            per_call(spent, calls),
            failed.len()
        ));
    }
    provider.stop_and_report()?;
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// A picture unlike all others, and smooth as photographs are.
fn noise_picture(number: usize) -> Result<Image, wayword_core::image::WrongPixelCount> {
    let (width, height) = (640u32, 480u32);
    // Two offsets, so that 65,536 pictures differ and not 256.
    let level = |x: u32, y: u32, offset: usize| ((x / 3 + y / 2 + offset as u32) % 256) as u8;
    let (offset, other) = (number * 7, number * 7 + number / 256);
    let pixels = (0..height)
        .flat_map(|y| (0..width).flat_map(move |x| [level(x, y, offset), level(y, x, offset), level(x, x + y, other)]));
    Image::new(width, height, pixels.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_testkit::provider::{
        PictureGallery, ProviderBehaviour, ProviderDialect, ScriptedProvider,
        scripts::{FlawedEye, ScriptedCast},
    };

    #[test]
    fn throughput_is_compared_with_the_limit_by_latency() {
        // 32 at a time and 200 ms for each are 160 a second; 5,000 in 40 s are 125.
        let told = describe_throughput(5000, Duration::from_secs(40), 200, 32);
        assert_eq!(told, "125.0 calls/s, 78.1 % of the ideal 160.0");
        assert_eq!(describe_throughput(5000, Duration::from_secs(40), 0, 32), "125.0 calls/s");
        assert_eq!(per_call(Duration::from_millis(1650), 5000), "0.33 ms");
    }

    #[test]
    fn calls_are_all_different_and_failures_are_counted() {
        let cast = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 0, 0.0), 0, 0.0);
        let provider = ScriptedProvider::start(ProviderBehaviour::for_model("words", cast)).unwrap();
        let base_url = provider.base_url(ProviderDialect::OpenAi);
        let client = TrialClient::new(&base_url, "server/words", RequestConcurrency::Fixed(3), 30.0).unwrap();
        assert_eq!(client.make_calls(20, words_request), Vec::<String>::new());
        assert_eq!((provider.log().answered, provider.log().distinct_answered()), (20, 20));
        let nobody = TrialClient::new(&base_url, "server/nobody", RequestConcurrency::Fixed(3), 30.0).unwrap();
        assert_eq!(nobody.make_calls(5, words_request).len(), 5);
        assert_eq!(provider.log().answered, 20);
    }

    /// Equal pictures would be encoded once and cached, and the measurement would be too low.
    #[test]
    fn no_two_pictures_of_the_measurement_are_alike() {
        let pictures: BTreeSet<Vec<u8>> =
            (1..=600).map(|number| noise_picture(number).unwrap().rgb_bytes()[..30_000].to_vec()).collect();
        assert_eq!(pictures.len(), 600);
    }
}
