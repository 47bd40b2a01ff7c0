//! The style that each text is checked against.

use super::{CheckReport, walks::Text};
use crate::{error::Error, styles};
use wayword_core::{Constraints, Style};
use wayword_synthesis::style::{built_in, built_in_names, hash};

/// The styles that texts are checked against.
pub(super) struct Held {
    /// The style that was asked for; it applies to all texts.
    given: Option<Style>,
    /// The built-in styles with their hashes. A user's own style may have the name of one, but never its hash.
    known: Vec<(String, Style)>,
    /// A style without constraints.
    any: Style,
}

impl Held {
    /// Checks against a style by its name, or each text against its own.
    pub(super) fn to(style: Option<&str>, seed: u64) -> Result<Self, Error> {
        let given = style.map(|name| styles::find(&[name.to_owned()], seed)).transpose()?;
        let given = given.and_then(|mut styles| styles.pop()).map(|measured| measured.style);
        let known = built_in_names().into_iter().map(built_in).collect::<Result<Vec<_>, _>>()?;
        let known = known.into_iter().map(|style| (hash(&style), style)).collect();
        let any = Style { name: "any".into(), references: Vec::new(), constraints: Constraints::default() };
        Ok(Self { given, known, any })
    }

    /// The style of a text, or one without constraints.
    pub(super) fn style_of(&self, text: &Text) -> &Style {
        self.given.as_ref().or_else(|| self.own(text)).unwrap_or(&self.any)
    }

    fn own(&self, text: &Text) -> Option<&Style> {
        let named = text.style.as_ref()?;
        self.known.iter().find(|(hash, style)| *hash == named.hash && style.name == named.name).map(|(_, style)| style)
    }

    /// Counts a text under its style. A text of a dataset that names no style is not counted.
    pub(super) fn count(&self, text: &Text, report: &mut CheckReport) {
        let (styles, name) = match (self.given.as_ref().or_else(|| self.own(text)), &text.style) {
            (Some(style), _) => (&mut report.styles, &style.name),
            (None, Some(named)) => (&mut report.unknown_styles, &named.name),
            (None, None) => return,
        };
        *styles.entry(name.clone()).or_default() += 1;
    }
}
