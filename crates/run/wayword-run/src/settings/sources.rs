//! The sources of evidence that texts are checked against, with their text form in flags and settings:
//! `labels,captions,detector`.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::{fmt, str::FromStr};

/// The sources of evidence that texts are checked against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EvidenceSources {
    /// The platform's labels, where it has them.
    pub labels: bool,
    /// The captions: beside the labels where a model saw, else alone.
    pub captions: bool,
    /// The finds and misses of a detector, where labels are not used.
    pub detector: bool,
}

impl EvidenceSources {
    /// The captions alone, as on a platform without labels.
    pub const CAPTIONS_ALONE: Self = Self { labels: false, captions: true, detector: false };

    /// Labels where there are any, else captions; and the detector, where there is one.
    #[must_use]
    pub fn usual_sources(has_detector: bool) -> Self {
        Self { labels: true, captions: true, detector: has_detector }
    }

    /// Whether captions are a source of their own. `labels` alone implies them where there are no labels, so they need not be named.
    #[must_use]
    pub fn names_captions(&self) -> bool {
        self.captions && (!self.labels || self.detector)
    }

    fn source_names(&self) -> Vec<&'static str> {
        let all = [(self.labels, "labels"), (self.names_captions(), "captions"), (self.detector, "detector")];
        all.into_iter().filter(|(is_used, _)| *is_used).map(|(_, name)| name).collect()
    }
}

impl Default for EvidenceSources {
    fn default() -> Self {
        Self::usual_sources(false)
    }
}

impl fmt::Display for EvidenceSources {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source_names().join(","))
    }
}

impl FromStr for EvidenceSources {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut sources = Self { labels: false, captions: false, detector: false };
        for name in text.split(',').map(str::trim) {
            let source = match name {
                "labels" => &mut sources.labels,
                "captions" => &mut sources.captions,
                "detector" => &mut sources.detector,
                _ => return Err(format!("{name:?} is none of labels, captions, detector")),
            };
            *source = true;
        }
        // `labels` alone falls back to captions on platforms without labels.
        sources.captions |= sources.labels && !sources.detector;
        Ok(sources)
    }
}

impl Serialize for EvidenceSources {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for EvidenceSources {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from)?.parse().map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_kept_as_they_are_typed() {
        for text in
            ["labels", "captions", "detector", "labels,captions,detector", "captions,detector", "labels,detector"]
        {
            assert_eq!(text.parse::<EvidenceSources>().unwrap().to_string(), text);
        }
        assert_eq!("labels".parse(), Ok(EvidenceSources::default()));
        assert_eq!("labels, captions".parse(), Ok(EvidenceSources::default()));
        assert!("label".parse::<EvidenceSources>().is_err() && "".parse::<EvidenceSources>().is_err());
    }
}
