//! Datasets of LeRobot. The first byte says which file of which dataset the rest replaces: Parquet with rows, with
//! pictures or with lists of episodes, or the JSON beside it.
//!
//! Third-party code reads Parquet (`parquet`), its compression (`snap`, `zstd`, `flate2`) and pictures (`image`); its
//! panics are contained. Memory: pages may unpack to 256 times their length, and a few rows may have 64 values for each
//! byte of a file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;
use wayword_fuzz::{Bound, begin, recording::walk, scratch, seeds::recordings};

const BOUND: Bound = Bound { flat: 600 << 20, per_byte: 8192 };
const DATASETS: [&str; 4] = ["v21_images", "v30_images", "v21_videos", "v30_videos"];

type Files = Vec<(String, Vec<u8>)>;

fn datasets() -> &'static [Files] {
    static FILES: OnceLock<Vec<Files>> = OnceLock::new();
    FILES.get_or_init(|| {
        DATASETS.iter().map(|name| recordings::files(&recordings::fixtures().join("lerobot").join(name))).collect()
    })
}

/// Every file of every dataset after its number, and Parquet of other programs in place of the first file.
fn seeds() -> Vec<Vec<u8>> {
    let all = datasets().iter().flatten().map(|(_, bytes)| bytes.clone());
    let mut seeds: Vec<Vec<u8>> = (0..).zip(all).map(|(number, bytes)| [vec![number], bytes].concat()).collect();
    seeds.retain(|seed| seed.len() < 64 << 10);
    seeds.extend(recordings::of_kind("parquet").into_iter().map(|bytes| [vec![0], bytes].concat()));
    seeds
}

fuzz_target!(init: begin("lerobot", &seeds()), |data: &[u8]| {
    let Some((which, file)) = data.split_first() else { return };
    let count: usize = datasets().iter().map(Vec::len).sum();
    let mut which = usize::from(*which) % count;
    let folder = scratch::folder();
    for dataset in datasets() {
        if which < dataset.len() {
            for (number, (name, usual)) in dataset.iter().enumerate() {
                scratch::write(folder.path(), name, if number == which { file } else { usual });
            }
            break;
        }
        which -= dataset.len();
    }
    BOUND.hold(data, || drop(walk(folder.path())));
});
