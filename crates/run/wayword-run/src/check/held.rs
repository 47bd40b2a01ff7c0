//! Chooses the style that each text is checked against: the one of `--style`, or the one that its record names.

use super::{CheckReport, walks::Text};
use crate::{
    error::Error,
    settings::Settings,
    styles::{self, Measured},
};
use std::sync::Arc;
use wayword_checks::Copies;
use wayword_core::Style;
use wayword_synthesis::style::{built_in, built_in_names, hash};

/// The styles that texts are checked against.
pub struct Held {
    /// The style that was asked for; it applies to all texts.
    given: Option<Known>,
    /// The built-in styles, and those of a run. A text's style is found by name and hash, because a user's own style may have
    /// the name of a built-in one.
    known: Vec<Known>,
    /// For texts that name no style, if their run has only one: its index in `known`.
    sole: Option<usize>,
    /// A style without constraints.
    any: Known,
}

/// A style, with everything that is computed from it once for all texts.
pub(super) struct Known {
    /// The style.
    pub(super) style: Style,
    /// The index of its reference texts.
    pub(super) copies: Arc<Copies>,
    hash: String,
}

impl Known {
    fn of(style: Style) -> Self {
        Self { copies: Arc::new(Copies::of(&style.references)), hash: hash(&style), style }
    }
}

impl From<Measured> for Known {
    fn from(Measured { style, profile, hash }: Measured) -> Self {
        Self { style, copies: profile.copies, hash }
    }
}

impl Held {
    /// Checks all texts against the style of that name, or each text against its own.
    pub(super) fn to(style: Option<&str>) -> Result<Self, Error> {
        let given = style.map(|name| styles::find(&[name.to_owned()])).transpose()?;
        let given = given.and_then(|mut styles| styles.pop()).map(Known::from);
        let known = built_in_names().into_iter().map(|name| built_in(name).map(Known::of)).collect::<Result<_, _>>()?;
        let any = Style { name: "any".into(), ..Style::default() };
        Ok(Self { given, known, sole: None, any: Known::of(any) })
    }

    /// The same with the styles of a run, as far as their files are still there.
    pub(super) fn of_run(style: Option<&str>, run: &Settings) -> Result<Self, Error> {
        let mut held = Self::to(style)?;
        let own = styles::find(&run.style).unwrap_or_default();
        held.sole = (own.len() == 1).then_some(held.known.len());
        held.known.extend(own.into_iter().map(Known::from));
        Ok(held)
    }

    /// The style of a text, or one without constraints.
    pub(super) fn style_of(&self, text: &Text) -> &Known {
        self.found(text).unwrap_or(&self.any)
    }

    fn found(&self, text: &Text) -> Option<&Known> {
        let sole = || self.known.get(self.sole.filter(|_| text.style.is_none())?);
        self.given.as_ref().or_else(|| self.own(text)).or_else(sole)
    }

    fn own(&self, text: &Text) -> Option<&Known> {
        let named = text.style.as_ref()?;
        self.known.iter().find(|known| known.hash == named.hash && known.style.name == named.name)
    }

    /// Counts a text under its style. A text of a dataset that names no style is not counted.
    pub(super) fn count(&self, text: &Text, report: &mut CheckReport) {
        let (styles, name) = match (self.found(text), &text.style) {
            (Some(known), _) => (&mut report.styles, &known.style.name),
            (None, Some(named)) => (&mut report.unknown_styles, &named.name),
            (None, None) => return,
        };
        *styles.entry(name.clone()).or_default() += 1;
    }
}
