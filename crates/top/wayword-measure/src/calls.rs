//! How many calls a second, at what cost of our own.

use crate::{provider::Process, resources};
use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use tempfile::TempDir;
use wayword::{error::Error, output::Output};
use wayword_core::{Image, LanguageModel, Message, Request, Role, Sampling};
use wayword_ledger::{Ledger, Limits};
use wayword_remote::{Concurrency, Config, RemoteModel, Services};

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

    /// Makes so many calls; `request` says what each asks. Returns the reasons of those that failed.
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

/// A prompt of about a hundred words that no other call has.
pub(super) fn words(number: usize) -> Request {
    request(Message::user(format!("Question {number}. {}", "What is to be seen on the left of the room? ".repeat(10))))
}

fn request(message: Message) -> Request {
    let sampling = Sampling { temperature: 0.0, max_tokens: 60, seed: 0 };
    Request { messages: vec![message], sampling, replicate: 0 }
}

/// Calls between two looks at the memory.
const LOOKS: [usize; 3] = [1_000, 10_000, 100_000];

pub(super) fn measure(calls: usize, latency_ms: u64, concurrency: usize, output: &Output) -> Result<(), Error> {
    let provider = Process::start(&["--latency-ms".to_owned(), latency_ms.to_string()])?;
    let client = Client::new(&provider.base_url, "server/words", Concurrency::Fixed(concurrency), 30.0)?;
    // What is made once, connections and threads, is made before.
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
    let per_s = calls as f64 / took.as_secs_f64();
    let own_ms = (resources::cpu() - cpu).as_secs_f64() * 1e3 / calls as f64;
    if latency_ms > 0 {
        let ideal = concurrency as f64 * 1e3 / latency_ms as f64;
        lines.push(format!("{per_s:.1} calls/s, {:.1} % of the ideal {ideal:.1}", 100.0 * per_s / ideal));
    } else {
        lines.push(format!("{per_s:.1} calls/s"));
    }
    lines.push(format!("{own_ms:.2} ms of our own processor time per call"));
    provider.end()?;
    output.data(&(), lines.join("\n"));
    Ok(())
}

/// Pictures apart: each its own, and one asked about ten times.
pub(super) fn pictures(calls: usize, output: &Output) -> Result<(), Error> {
    let provider = Process::start(&[])?;
    let mut lines = Vec::new();
    for (asked, what) in [(1, "each picture asked about once"), (10, "each picture asked about ten times")] {
        let client = Client::new(&provider.base_url, "server/eye", Concurrency::Fixed(8), 30.0)?;
        let images: Vec<Arc<Image>> =
            (0..calls / asked).filter_map(|number| noise(number + asked).ok().map(Arc::new)).collect();
        let cpu = resources::cpu();
        let failed = client.make(calls, |number| {
            let image = images.get(number / asked).cloned();
            request(Message { role: Role::User, text: format!("Question: what is {number}?\nAnswer:"), image })
        });
        let own: Duration = resources::cpu() - cpu;
        lines.push(format!(
            "{what} (640 x 480): {:.2} ms of our own processor time per call, {} failed",
            own.as_secs_f64() * 1e3 / calls as f64,
            failed.len()
        ));
    }
    provider.end()?;
    output.data(&(), lines.join("\n"));
    Ok(())
}

/// A picture that no other is like, smooth as photographs are.
fn noise(number: usize) -> Result<Image, wayword_core::image::WrongPixelCount> {
    let (width, height) = (640u32, 480u32);
    let level = |x: u32, y: u32| ((x / 3 + y / 2 + number as u32 * 7) % 256) as u8;
    let pixels = (0..height).flat_map(|y| (0..width).flat_map(move |x| [level(x, y), level(y, x), level(x, x + y)]));
    Image::new(width, height, pixels.collect())
}
