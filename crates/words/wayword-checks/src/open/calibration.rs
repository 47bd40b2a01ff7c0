//! Corrections to the weights for single names of objects and rooms, fitted on the user's own dataset. People name
//! some things more reliably than their class, and some less.

use super::{claim_sight::MissedClaim, claims::PlaceClaim, weights::SilenceWeights};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_language::lexicon::{kinds_of, room_name};

/// An offset to the logarithm of a likelihood ratio, by the name of the claimed place.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// The platform with the labels that it was made with.
    pub platform: String,
    /// The file that it was made from.
    pub from: String,
    /// How many texts that file has.
    pub texts: usize,
    /// By name.
    pub names: BTreeMap<String, NameOffsets>,
}

/// The offsets of one name, by how far away the nearest listed place of that name is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NameOffsets {
    /// Up to 8 m.
    pub close: f64,
    /// Farther.
    pub far: f64,
    /// The building lists none.
    pub nowhere: f64,
}

/// A claim that is not listed within reach, for a calibration.
#[derive(Debug, Clone)]
pub struct ClaimObservation<'a> {
    /// The claim.
    pub claim: &'a PlaceClaim,
    /// Its features in the evidence.
    pub missed: &'a MissedClaim,
    /// Whether the claim is wrong.
    pub wrong: bool,
    /// How much it counts.
    pub weight: f64,
}

/// The logarithm of a claim's ratio by the general weights, whether it is wrong, and how much it counts.
type WeighedClaim = (f64, bool, f64);

/// The largest offset: a factor of 20. It also bounds the effect of an untrusted file.
const MAX_OFFSET_LN: f64 = 3.0;
/// The general weights count as much as this many claims of a name, which keeps rare names close to them.
const RIDGE_CLAIMS: f64 = 4.0;
/// Steps of Newton's method for each offset.
const NEWTON_STEPS: usize = 30;
/// A name decides by itself from this offset on, where the odds double.
const TELLING_OFFSET_LN: f64 = std::f64::consts::LN_2;

impl Calibration {
    /// Checks a calibration that comes from a file.
    ///
    /// # Errors
    /// When it holds a number that is not finite; the text names the entry.
    pub fn check_numbers(&self) -> Result<(), String> {
        let is_finite = |offsets: &NameOffsets| {
            [offsets.close, offsets.far, offsets.nowhere].iter().all(|offset| offset.is_finite())
        };
        match self.names.iter().find(|(_, offsets)| !is_finite(offsets)) {
            Some((name, _)) => Err(format!("{name:?} has a number that is not finite")),
            None => Ok(()),
        }
    }

    /// The offset to the logarithm of a claim's likelihood ratio.
    #[must_use]
    pub fn offset_for(&self, claim: &PlaceClaim, missed: &MissedClaim) -> f64 {
        let offsets = self.names.get(&calibration_name(claim));
        offsets.map_or(0.0, |offsets| offsets.for_missed(missed)).clamp(-MAX_OFFSET_LN, MAX_OFFSET_LN)
    }

    /// Whether a missing label leaves it open that a thing of this name is nearby, because people are often right
    /// about it there. `None` where the calibration knows the name too little.
    #[must_use]
    pub fn leaves_open(&self, name: &str) -> Option<bool> {
        let close = kinds_of(name).into_iter().find_map(|kind| self.names.get(&kind))?.close;
        (close.abs() >= TELLING_OFFSET_LN).then_some(close < 0.0)
    }

    /// Fits the offsets of single names to the general weights. Each name is fitted by itself.
    #[must_use]
    pub fn fit_names(platform: &str, from: &str, texts: usize, observed: &[ClaimObservation<'_>]) -> Self {
        let weights = SilenceWeights::shipped();
        let mut cells: BTreeMap<(String, usize), Vec<WeighedClaim>> = BTreeMap::new();
        for claim in observed {
            let Some(ratio) = weights.log_ratio(claim.missed) else { continue };
            let cell = cells.entry((calibration_name(claim.claim), distance_cell(claim.missed))).or_default();
            cell.push((ratio, claim.wrong, claim.weight));
        }
        let mut names: BTreeMap<String, NameOffsets> = BTreeMap::new();
        for ((name, cell), observed) in cells {
            let offset = (fit_offset(&observed) * 1e3).round() / 1e3;
            *names.entry(name).or_default().cell_mut(cell) = offset;
        }
        Self { platform: platform.to_owned(), from: from.to_owned(), texts, names }
    }
}

impl NameOffsets {
    fn for_missed(mut self, missed: &MissedClaim) -> f64 {
        *self.cell_mut(distance_cell(missed))
    }

    fn cell_mut(&mut self, cell: usize) -> &mut f64 {
        match cell {
            0 => &mut self.close,
            1 => &mut self.far,
            _ => &mut self.nowhere,
        }
    }
}

/// The number of the cell of [`NameOffsets`] for a claim: 0 up to 8 m, 1 farther, 2 where the building lists none.
fn distance_cell(missed: &MissedClaim) -> usize {
    match missed.nearest_m {
        m if m <= 8.0 => 0,
        m if m.is_finite() => 1,
        _ => 2,
    }
}

/// The name under which a claim is counted.
fn calibration_name(claim: &PlaceClaim) -> String {
    match room_name(&claim.name).filter(|_| claim.is_only_room()) {
        Some(room) => room.to_owned(),
        None => kinds_of(&claim.name).swap_remove(0),
    }
}

/// The offset at which the observed claims are likeliest, by Newton's method.
fn fit_offset(observed: &[WeighedClaim]) -> f64 {
    let mut offset = 0.0;
    for _ in 0..NEWTON_STEPS {
        // The slope and the curvature of the log-likelihood, drawn towards 0 by the ridge.
        let (mut slope, mut curvature) = (-RIDGE_CLAIMS * offset, RIDGE_CLAIMS);
        for (ratio, wrong, weight) in observed {
            let chance = 1.0 / (1.0 + (-(ratio + offset)).exp());
            slope += (f64::from(u8::from(*wrong)) - chance) * weight;
            curvature += chance * (1.0 - chance) * weight;
        }
        offset = (offset + slope / curvature).clamp(-MAX_OFFSET_LN, MAX_OFFSET_LN);
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_often_right_where_it_is_not_listed_is_believed_more() {
        let often_right: Vec<_> = (0..40).map(|at| (1.0, at % 4 == 0, 1.0)).collect();
        let often_wrong: Vec<_> = (0..40).map(|at| (1.0, at % 10 != 0, 1.0)).collect();
        assert!(fit_offset(&often_right) < -0.5);
        assert!(fit_offset(&often_wrong) > 0.5);
        assert!(fit_offset(&often_wrong[..1]).abs() < 0.3, "one claim says little");
    }

    #[test]
    fn a_file_holds_finite_numbers_and_no_unknown_keys() {
        let head = "platform = \"matterport\"\nfrom = \"a.json\"\ntexts = 1\n";
        let read = |rest: &str| toml::from_str::<Calibration>(&format!("{head}{rest}"));
        let sound = read("[names.sofa]\nclose = 99.0\nfar = 1.0\nnowhere = 0.0").unwrap();
        assert_eq!((sound.check_numbers(), sound.names["sofa"].close), (Ok(()), 99.0));
        for number in ["nan", "inf", "-inf"] {
            let odd = read(&format!("[names.sofa]\nclose = 1.0\nfar = {number}\nnowhere = 0.0")).unwrap();
            assert!(odd.check_numbers().unwrap_err().contains("sofa"), "{number}");
        }
        assert!(read("words = 1\n[names]").is_err());
    }
}
