//! A scripted model service, for trying a run with models where no model is available. It answers as OpenAI-compatible
//! servers do, and its models are `server/words` and `server/eye`. It does not look at pictures: it invents a description
//! from the picture's bytes.
//!
//! `cargo run -p wayword-testkit --example provider` prints the address for `--base-url` and serves until it is
//! interrupted.

#![allow(clippy::print_stdout, reason = "an example prints what it does")]

use wayword_testkit::provider::{
    PictureGallery, ProviderBehaviour, ProviderDialect, ScriptedProvider,
    scripts::{FlawedEye, ScriptedCast},
};

fn main() -> std::io::Result<()> {
    let cast = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 1, 0.0), 1, 0.0);
    let provider = ScriptedProvider::start(ProviderBehaviour::for_model("words", cast.clone()).and_model("eye", cast))?;
    println!("{}", provider.base_url(ProviderDialect::OpenAi));
    loop {
        std::thread::park();
    }
}
