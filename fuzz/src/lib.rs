//! Code that the fuzz targets share: a bound on memory, a rule about panics, and seeds.

pub mod habitat;
pub mod recording;
pub mod scratch;
pub mod seeds;
pub mod tape;
pub mod virtualhome;

use peak_alloc::PeakAlloc;
use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex, PoisonError, atomic::AtomicBool},
};
use wayword_core::contain_panics::is_contained;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Most memory that one input may take: a flat amount for every input, plus an amount for each of its bytes.
pub struct Bound {
    pub flat: usize,
    pub per_byte: usize,
}

impl Bound {
    /// Runs a target on an input. Panics where more is allocated at any one time than the bound allows.
    pub fn hold(&self, input: &[u8], target: impl FnOnce()) {
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        target();
        let taken = MEMORY.peak_usage().saturating_sub(before);
        let allowed = self.flat + self.per_byte * input.len();
        assert!(taken <= allowed, "{} bytes of input took {taken} bytes of memory: {allowed} are allowed", input.len());
    }
}

/// Puts seeds into the target's corpus and sets the rule about panics. Call it once.
///
/// libFuzzer's hook ends the process at every panic. This one lets a panic pass that is contained and in another
/// crate's code, and prints the place of each of these once.
pub fn begin(target: &str, seeds: &[Vec<u8>]) {
    seeds::sow(target, seeds);
    let piped = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGPIPE, piped).expect("a handler of SIGPIPE");
    let ending = std::panic::take_hook();
    let told = Mutex::new(BTreeSet::new());
    std::panic::set_hook(Box::new(move |panic| {
        let place = panic.location().map(|place| place.to_string()).unwrap_or_default();
        if !is_contained() || !(place.contains("/registry/src/") || place.starts_with("/rustc/")) {
            ending(panic);
        } else if told.lock().unwrap_or_else(PoisonError::into_inner).insert(place) {
            eprintln!("contained: {panic}");
        }
    }));
}
