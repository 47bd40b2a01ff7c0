//! Calls per second, and this program's own processor time and memory.

use crate::provider::Process;
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use tempfile::TempDir;
use wayword_core::{Image, LanguageModel, Message, Request, Sampling};
use wayword_ledger::{Ledger, Limits};
use wayword_remote::{Concurrency, Config, RemoteModel, Services};
use wayword_run::{error::Error, output::Output};
use wayword_testkit::resources;

/// A model of a provider, with a ledger on disk.
pub(super) struct Client {
    pub(super) model: Arc<RemoteModel>,
    concurrency: Concurrency,
    _folder: TempDir,
}

impl Client {
    pub(super) fn new(base_url: &str, model: &str, concurrency: Concurrency, timeout_s: f64) -> Result<Self, Error> {
        let folder = tempfile::tempdir().map_err(|source| Error::Io {
            path: std::env::temp_dir(),
            doing: "put a ledger into",
            source,
        })?;
        let run = Ledger::open(&folder.path().join("ledger.db"))?.run("measure", Limits::default())?;
        let config = Config { base_url: Some(base_url.to_owned()), concurrency, timeout_s, ..Config::default() };
        Ok(Self { model: Services::new(config, run)?.model(model)?, concurrency, _folder: folder })
    }

    /// Makes `calls` calls with requests that `request` builds from the call's number. Returns the errors of the calls that failed.
    pub(super) fn make(&self, calls: usize, request: impl Fn(usize) -> Request + Sync) -> Vec<String> {
        let next = AtomicUsize::new(0);
        let failed: Mutex<Vec<String>> = Mutex::default();
        thread::scope(|scope| {
            for _ in 0..self.concurrency.threads() {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= calls {
                            break;
                        }
                        for error in self.model.complete(&[request(number)]).into_iter().filter_map(Result::err) {
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
pub(super) fn words(number: usize) -> Request {
    request(Message::user(format!("Question {number}. {}", "What is to be seen on the left of the room? ".repeat(10))))
}

fn request(message: Message) -> Request {
    let sampling = Sampling { temperature: 0.0, max_tokens: 60, seed: 0 };
    Request { messages: vec![message], sampling, replicate: 0, schema: None, tools: &[] }
}

/// The memory is measured after these numbers of calls.
const LOOKS: [usize; 3] = [1_000, 10_000, 100_000];

pub(super) fn measure(calls: usize, latency_ms: u64, concurrency: usize, output: &Output) -> Result<(), Error> {
    let provider = Process::start(&["--latency-ms".to_owned(), latency_ms.to_string()])?;
    let client = Client::new(&provider.base_url, "server/words", Concurrency::Fixed(concurrency), 30.0)?;
    // Connections and threads are made once, so they are made before the measurement.
    client.make(concurrency, |number| words(usize::MAX / 2 + number));
    let (begun, cpu) = (Instant::now(), resources::cpu());
    let mut done = 0;
    let mut lines = Vec::new();
    for until in LOOKS.into_iter().filter(|look| *look < calls).chain([calls]) {
        let failed = client.make(until - done, |number| words(done + number));
        done = until;
        lines.push(format!(
            "after {until} calls: {:.1} MiB resident, {} failed",
            resources::resident_mib(),
            failed.len()
        ));
    }
    let took = begun.elapsed();
    lines.push(throughput(calls, took, latency_ms, concurrency));
    lines.push(format!("{} of this program's processor time per call", per_call(resources::cpu() - cpu, calls)));
    provider.end()?;
    output.data(&(), lines.join("\n"));
    Ok(())
}

/// Calls per second, and their share of the most that is possible with this latency and concurrency.
fn throughput(calls: usize, took: Duration, latency_ms: u64, concurrency: usize) -> String {
    let per_s = calls as f64 / took.as_secs_f64();
    if latency_ms == 0 {
        return format!("{per_s:.1} calls/s");
    }
    let ideal = concurrency as f64 * 1e3 / latency_ms as f64;
    format!("{per_s:.1} calls/s, {:.1} % of the ideal {ideal:.1}", 100.0 * per_s / ideal)
}

fn per_call(time: Duration, calls: usize) -> String {
    format!("{:.2} ms", time.as_secs_f64() * 1e3 / calls as f64)
}

/// Calls with pictures: each picture asked about once, then ten times.
pub(super) fn pictures(calls: usize, output: &Output) -> Result<(), Error> {
    let provider = Process::start(&[])?;
    let mut lines = Vec::new();
    for (asked, what) in [(1, "each picture asked about once"), (10, "each picture asked about ten times")] {
        let client = Client::new(&provider.base_url, "server/eye", Concurrency::Fixed(8), 30.0)?;
        let images: Vec<Arc<Image>> =
            (0..calls / asked).filter_map(|number| noise(number + asked).ok().map(Arc::new)).collect();
        let cpu = resources::cpu();
        let failed = client.make(calls, |number| {
            let image = images.get(number / asked).cloned().into_iter().collect();
            request(Message::about(format!("Question: what is {number}?\nAnswer:"), image))
        });
        let own: Duration = resources::cpu() - cpu;
        lines.push(format!(
            "{what} (640 x 480): {} of this program's processor time per call, {} failed",
            per_call(own, calls),
            failed.len()
        ));
    }
    provider.end()?;
    output.data(&(), lines.join("\n"));
    Ok(())
}

/// A picture unlike all others, and smooth as photographs are.
fn noise(number: usize) -> Result<Image, wayword_core::image::WrongPixelCount> {
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
        Behaviour, Dialect, Gallery, Provider,
        scripts::{Cast, FlawedEye},
    };

    #[test]
    fn throughput_is_compared_with_the_limit_by_latency() {
        // 32 at a time and 200 ms for each are 160 a second; 5,000 in 40 s are 125.
        let told = throughput(5000, Duration::from_secs(40), 200, 32);
        assert_eq!(told, "125.0 calls/s, 78.1 % of the ideal 160.0");
        assert_eq!(throughput(5000, Duration::from_secs(40), 0, 32), "125.0 calls/s");
        assert_eq!(per_call(Duration::from_millis(1650), 5000), "0.33 ms");
    }

    #[test]
    fn calls_are_all_different_and_failures_are_counted() {
        let cast = Cast::new(FlawedEye::new(Gallery::default(), 0, 0.0), 0, 0.0);
        let provider = Provider::start(Behaviour::of("words", cast)).unwrap();
        let base_url = provider.base_url(Dialect::OpenAi);
        let client = Client::new(&base_url, "server/words", Concurrency::Fixed(3), 30.0).unwrap();
        assert_eq!(client.make(20, words), Vec::<String>::new());
        assert_eq!((provider.log().answered, provider.log().distinct_answered()), (20, 20));
        let nobody = Client::new(&base_url, "server/nobody", Concurrency::Fixed(3), 30.0).unwrap();
        assert_eq!(nobody.make(5, words).len(), 5);
        assert_eq!(provider.log().answered, 20);
    }

    /// Equal pictures would be encoded once and cached, and the measurement would be too low.
    #[test]
    fn no_two_pictures_of_the_measurement_are_alike() {
        let pictures: BTreeSet<Vec<u8>> =
            (1..=600).map(|number| noise(number).unwrap().rgb()[..30_000].to_vec()).collect();
        assert_eq!(pictures.len(), 600);
    }
}
