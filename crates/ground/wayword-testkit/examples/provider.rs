//! A scripted model service, for trying a run with models where no model is available. It answers as OpenAI-compatible
//! servers do, and its models are `server/words` and `server/eye`. It does not look at pictures: it invents a description
//! from the picture's bytes.
//!
//! `cargo run -p wayword-testkit --example provider` prints the address for `--base-url` and serves until it is
//! interrupted.

#![allow(clippy::print_stdout, reason = "an example prints what it does")]

use wayword_testkit::provider::{
    Behaviour, Dialect, Gallery, Provider,
    scripts::{Cast, FlawedEye},
};

fn main() -> std::io::Result<()> {
    let cast = Cast::new(FlawedEye::new(Gallery::default(), 1, 0.0), 1, 0.0);
    let provider = Provider::start(Behaviour::of("words", cast.clone()).and("eye", cast))?;
    println!("{}", provider.base_url(Dialect::OpenAi));
    loop {
        std::thread::park();
    }
}
