//! The program accepts the settings that `docs/MODELS.md` shows.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use wayword_remote::PriceTable;
use wayword_run::{calls::ModelCalls, settings::AskedSettings};

/// The blocks of TOML in a document.
fn blocks(document: &str) -> Vec<String> {
    let path = format!("{}/../../../docs/{document}", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).unwrap().replace("\r\n", "\n");
    let blocks = text.split("```toml\n").skip(1).map(|block| block.split_once("\n```").unwrap().0.to_owned());
    blocks.collect()
}

/// A block begins with a comment that names its file.
#[test]
fn the_settings_and_prices_of_the_documents_are_read() {
    let (mut settings, mut prices) = (0, 0);
    for block in blocks("MODELS.md") {
        let (name, _) = block.split_once('\n').unwrap();
        if name == "# prices.toml" {
            PriceTable::from_toml(&block).unwrap();
            prices += 1;
        } else {
            let asked: AskedSettings = toml::from_str(&block).unwrap_or_else(|error| panic!("{block}\n{error}"));
            let job = asked.into_job().unwrap_or_else(|error| panic!("{block}\n{error}"));
            ModelCalls::rehearse_job(&job).unwrap_or_else(|error| panic!("{block}\n{error}"));
            settings += 1;
        }
    }
    assert!(settings > 0 && prices > 0, "no block is marked as toml any more");
}
