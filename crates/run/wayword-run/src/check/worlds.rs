//! Decides in which world each text is checked.

use super::path_texts::FileText;
use crate::check::args::AskedWorld;
use wayword_checks::{CheckWorld, EvidenceSource};

/// The world in which a text is checked. With `--world auto` it is closed for a record with the same platform and
/// source of evidence as in this check, because such a text was written from this evidence, and open for every other
/// text.
pub(super) fn choose_world(text: &FileText, asked: AskedWorld, platform: &str, source: EvidenceSource) -> CheckWorld {
    match (asked, &text.origin) {
        (AskedWorld::Open, _) | (AskedWorld::Auto, None) => CheckWorld::Open,
        (AskedWorld::Closed, _) => CheckWorld::Closed,
        (AskedWorld::Auto, Some((made_on, provenance))) => {
            CheckWorld::for_record(provenance, made_on, platform, source)
        }
    }
}
