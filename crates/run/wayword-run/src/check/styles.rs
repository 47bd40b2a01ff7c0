//! Chooses the style that each text is checked against: the one of `--style`, or the one that its record names.

use super::{CheckReport, path_texts::FileText};
use crate::{
    error::CommandError,
    settings::RunSettings,
    styles::{self, MeasuredStyle},
};
use std::sync::Arc;
use wayword_checks::{ReferenceRuns, TextFindings};
use wayword_core::{CheckKind, InstructionStyle, Verdict};
use wayword_synthesis::style::{built_in, built_in_names, hash_style};

/// The styles that texts are checked against.
pub(super) struct CheckStyles {
    /// The style that was asked for; it applies to all texts.
    given: Option<CheckStyle>,
    /// The built-in styles, and those of a run. A text's style is found by name and hash, because a user's own style may have
    /// the name of a built-in one.
    known: Vec<CheckStyle>,
    /// For texts that name no style, if their run has only one: its index in `known`.
    sole: Option<usize>,
    /// A style without constraints.
    any: CheckStyle,
}

/// A style, with everything that is computed from it once for all texts.
pub(super) struct CheckStyle {
    /// The style.
    pub(super) style: InstructionStyle,
    /// The index of its reference texts.
    pub(super) copies: Arc<ReferenceRuns>,
    hash: String,
}

impl CheckStyle {
    fn from_style(style: InstructionStyle) -> Self {
        Self { copies: Arc::new(ReferenceRuns::from_references(&style.references)), hash: hash_style(&style), style }
    }
}

impl From<MeasuredStyle> for CheckStyle {
    fn from(MeasuredStyle { style, profile, hash }: MeasuredStyle) -> Self {
        Self { style, copies: profile.copies, hash }
    }
}

impl CheckStyles {
    /// Checks all texts against the style of that name, or each text against its own.
    pub(super) fn for_style(style: Option<&str>) -> Result<Self, CommandError> {
        let given = style.map(|name| styles::find_styles(&[name.to_owned()])).transpose()?;
        let given = given.and_then(|mut styles| styles.pop()).map(CheckStyle::from);
        let known = built_in_names()
            .into_iter()
            .map(|name| built_in(name).map(CheckStyle::from_style))
            .collect::<Result<_, _>>()?;
        let any = InstructionStyle { name: "any".into(), ..InstructionStyle::default() };
        Ok(Self { given, known, sole: None, any: CheckStyle::from_style(any) })
    }

    /// As [`Self::for_style`], with the styles of a run in addition, as far as their files are still there.
    pub(super) fn for_run(style: Option<&str>, run: &RunSettings) -> Result<Self, CommandError> {
        let mut check_styles = Self::for_style(style)?;
        let run_styles = styles::find_run_styles(run).unwrap_or_default();
        check_styles.sole = (run_styles.len() == 1).then_some(check_styles.known.len());
        check_styles.known.extend(run_styles.into_iter().map(CheckStyle::from));
        Ok(check_styles)
    }

    /// The style of a text, or one without constraints.
    pub(super) fn style_or_any(&self, text: &FileText) -> &CheckStyle {
        self.find_style(text).unwrap_or(&self.any)
    }

    /// Leaves out the checks that passed because no style is known, which sets what they check.
    pub(super) fn leave_out_unasked(&self, text: &FileText, checked: &mut TextFindings) {
        if self.find_style(text).is_none() {
            let is_of_style = |check| matches!(check, CheckKind::Form | CheckKind::Leak);
            checked.findings.retain(|finding| !is_of_style(finding.check) || finding.verdict != Verdict::Pass);
        }
    }

    /// The style that was asked for, else the one that the text names, else the only one of its run.
    fn find_style(&self, text: &FileText) -> Option<&CheckStyle> {
        let sole = || self.known.get(self.sole.filter(|_| text.style.is_none())?);
        self.given.as_ref().or_else(|| self.own_style(text)).or_else(sole)
    }

    fn own_style(&self, text: &FileText) -> Option<&CheckStyle> {
        let named = text.style.as_ref()?;
        self.known.iter().find(|known| known.hash == named.hash && known.style.name == named.name)
    }

    /// Counts a text under its style. A text of a dataset that names no style is not counted.
    pub(super) fn count_text(&self, text: &FileText, report: &mut CheckReport) {
        let (styles, name) = match (self.find_style(text), &text.style) {
            (Some(known), _) => (&mut report.styles, &known.style.name),
            (None, Some(named)) => (&mut report.unknown_styles, &named.name),
            (None, None) => return,
        };
        *styles.entry(name.clone()).or_default() += 1;
    }
}
