//! Opens sentence encoders by name, and turns texts into vectors with them.

use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{ModelError, TextEncoder};
use wayword_metrics::HashedWordEncoder;
use wayword_run::{error::CommandError, interrupt, output::CommandOutput};

/// Number of texts that the encoder gets at once.
const ENCODER_BATCH_TEXTS: usize = 128;

/// The encoder that counts words, without a model.
pub(crate) const WORD_ENCODER: &str = "words";

/// Opens an encoder by its name. `words` counts words, without a model.
pub fn open_encoder(name: &str) -> Result<Box<dyn TextEncoder>, CommandError> {
    if name == WORD_ENCODER { Ok(Box::new(HashedWordEncoder)) } else { in_process(name) }
}

#[cfg(feature = "local")]
fn in_process(name: &str) -> Result<Box<dyn TextEncoder>, CommandError> {
    use wayword_local::{HubConfig, ModelDevice, ModelHub, ModelName, NeededFiles, SentenceEncoder, WeightPrecision};
    let needs = NeededFiles::for_sentence_encoder();
    let folder = ModelHub::new(HubConfig::from_env()?)?.model_folder(&ModelName::parse(name)?, &needs, &())?;
    Ok(Box::new(SentenceEncoder::load(name, &folder.path, &ModelDevice::cpu(), WeightPrecision::F32)?))
}

#[cfg(not(feature = "local"))]
fn in_process(name: &str) -> Result<Box<dyn TextEncoder>, CommandError> {
    Err(CommandError::usage(
        format!("{name}: this build runs no models in process"),
        "build it with `cargo build --release --features full`, or count words with `--encoder words`",
    ))
}

/// Encodes texts, equal ones once, and gives the vector of each.
pub fn encode_texts<'a>(
    encoder: &dyn TextEncoder,
    texts: impl Iterator<Item = &'a str>,
    output: &CommandOutput,
) -> Result<BTreeMap<&'a str, Vec<f32>>, CommandError> {
    let texts: Vec<&str> = texts.collect::<BTreeSet<_>>().into_iter().collect();
    let bar = output.progress_bar(texts.len(), "texts");
    let mut vectors = BTreeMap::new();
    let mut vector_length = None;
    for batch in texts.chunks(ENCODER_BATCH_TEXTS) {
        interrupt::check_interrupt()?;
        let encoded = encoder.encode_texts(batch)?;
        let expected = *vector_length.get_or_insert_with(|| encoded.first().map_or(0, Vec::len));
        let fits = |vector: &Vec<f32>| vector.len() == expected && vector.iter().all(|number| number.is_finite());
        if encoded.len() != batch.len() || !encoded.iter().all(fits) {
            let reason = "it did not give one vector of finite numbers for each text".to_owned();
            return Err(ModelError::Failed { model: encoder.name().to_owned(), reason }.into());
        }
        vectors.extend(batch.iter().copied().zip(encoded));
        bar.inc(batch.len() as u64);
    }
    bar.finish_and_clear();
    Ok(vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Always gives the same vector, and records the texts that it was given.
    struct Fixed(Vec<f32>, Mutex<Vec<String>>);

    impl TextEncoder for Fixed {
        fn name(&self) -> &str {
            "fixed"
        }

        fn encode_texts(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, ModelError> {
            self.1.lock().unwrap().extend(texts.iter().map(|text| (*text).to_owned()));
            Ok(texts.iter().skip(usize::from(self.0.is_empty())).map(|_| self.0.clone()).collect())
        }
    }

    fn encode_with(vector: Vec<f32>) -> Result<Vec<String>, CommandError> {
        let encoder = Fixed(vector, Mutex::default());
        encode_texts(&encoder, ["b", "a", "b", "a"].into_iter(), &CommandOutput::new(false, true))?;
        Ok(encoder.1.into_inner().unwrap())
    }

    #[test]
    fn a_text_is_encoded_once() {
        assert_eq!(encode_with(vec![1.0]).unwrap(), ["a", "b"]);
    }

    #[test]
    fn an_encoder_that_gives_no_vectors_is_refused() {
        for wrong in [vec![f32::NAN], Vec::new()] {
            assert!(encode_with(wrong).unwrap_err().to_string().contains("fixed"));
        }
    }
}
