//! The style that each text is checked against.

use super::{CheckReport, walks::Text};
use crate::{
    error::Error,
    settings::Settings,
    styles::{self, Measured},
};
use wayword_checks::Copies;
use wayword_core::{Constraints, Style};
use wayword_synthesis::style::{built_in, built_in_names, hash};

/// The styles that texts are checked against.
pub(super) struct Held {
    /// The style that was asked for; it applies to all texts.
    given: Option<Measured>,
    /// The built-in styles with their hashes. A user's own style may have the name of one, but never its hash.
    known: Vec<(String, Style)>,
    /// The style of texts that name none, where their run has one style only.
    sole: Option<Style>,
    /// A style without constraints.
    any: Style,
}

impl Held {
    /// Checks against a style by its name, or each text against its own.
    pub(super) fn to(style: Option<&str>) -> Result<Self, Error> {
        let given = style.map(|name| styles::find(&[name.to_owned()])).transpose()?;
        let given = given.and_then(|mut styles| styles.pop());
        let known = built_in_names().into_iter().map(built_in).collect::<Result<Vec<_>, _>>()?;
        let known = known.into_iter().map(|style| (hash(&style), style)).collect();
        let any = Style { name: "any".into(), references: Vec::new(), constraints: Constraints::default() };
        Ok(Self { given, known, sole: None, any })
    }

    /// The same with the styles of a run, as far as their files are still there.
    pub(super) fn of_run(style: Option<&str>, run: &Settings) -> Result<Self, Error> {
        let mut held = Self::to(style)?;
        let own: Vec<Style> = styles::find(&run.style)
            .map_or_else(|_| Vec::new(), |styles| styles.into_iter().map(|measured| measured.style).collect());
        held.known.extend(own.iter().map(|style| (hash(style), style.clone())));
        held.sole = <[Style; 1]>::try_from(own).ok().map(|[only]| only);
        Ok(held)
    }

    /// The style of a text, or one without constraints.
    pub(super) fn style_of(&self, text: &Text) -> &Style {
        self.given().or_else(|| self.own(text)).or_else(|| self.sole_of(text)).unwrap_or(&self.any)
    }

    fn sole_of(&self, text: &Text) -> Option<&Style> {
        self.sole.as_ref().filter(|_| text.style.is_none())
    }

    fn given(&self) -> Option<&Style> {
        self.given.as_ref().map(|measured| &measured.style)
    }

    /// The index of the reference texts of the style that was asked for.
    pub(super) fn copies(&self) -> Option<&Copies> {
        self.given.as_ref().map(|measured| &*measured.profile.copies)
    }

    fn own(&self, text: &Text) -> Option<&Style> {
        let named = text.style.as_ref()?;
        self.known.iter().find(|(hash, style)| *hash == named.hash && style.name == named.name).map(|(_, style)| style)
    }

    /// Counts a text under its style. A text of a dataset that names no style is not counted.
    pub(super) fn count(&self, text: &Text, report: &mut CheckReport) {
        let style = self.given().or_else(|| self.own(text)).or_else(|| self.sole_of(text));
        let (styles, name) = match (style, &text.style) {
            (Some(style), _) => (&mut report.styles, &style.name),
            (None, Some(named)) => (&mut report.unknown_styles, &named.name),
            (None, None) => return,
        };
        *styles.entry(name.clone()).or_default() += 1;
    }
}
