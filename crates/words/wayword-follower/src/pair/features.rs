//! The features of a pair by which its chance to be wrong is computed.

use super::{
    claims::{FilmClaimFit, FilmClaimKind},
    cut::FilmedText,
};
use wayword_language::lexicon::find_thing;

/// Counts above this are alike.
const MOST_COUNTED: usize = 3;

/// The features of a text on the best way to cut its film. `total` is the logarithm of the sum over all ways.
pub(super) fn pair_features(
    filmed: &FilmedText<'_>,
    stretches: &[[usize; 2]],
    fits: &[FilmClaimFit],
    total: f64,
) -> Vec<(String, f64)> {
    let mut features = vec![("bias".to_owned(), 1.0)];
    add_fit_counts(filmed, fits, &mut features);
    add_steps("score", total / filmed.text.parts.len() as f64, &[-4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0], &mut features);
    if let Some(gain) = filmed.best_flip_gain() {
        add_steps("flip gain", gain, &[-3.0, -1.5, -0.5, 0.0, 0.5, 1.5, 3.0], &mut features);
    }
    add_steps("shift", largest_shift(filmed, stretches), &[0.1, 0.2, 0.3, 0.4], &mut features);
    add_count("untold turns", untold_turns(filmed, stretches), &mut features);
    add_end(filmed, fits, &mut features);
    features
}

/// Whether a claim is of a kind.
type ClaimTest = fn(&FilmClaimKind) -> bool;

/// How many claims of each kind fit in each way, and which share of the places that can be decided were not seen.
fn add_fit_counts(filmed: &FilmedText<'_>, fits: &[FilmClaimFit], features: &mut Vec<(String, f64)>) {
    let kinds: [(&str, ClaimTest); 5] = [
        ("turn", |kind| matches!(kind, FilmClaimKind::Turn { .. } | FilmClaimKind::Around)),
        ("stairs", |kind| matches!(kind, FilmClaimKind::Climb(_))),
        ("room", is_room),
        ("thing", |kind| matches!(kind, FilmClaimKind::Place { .. }) && !is_room(kind)),
        ("rare thing", is_rare_thing),
    ];
    let ways = [
        ("fits", FilmClaimFit::Fits),
        ("perhaps", FilmClaimFit::Perhaps),
        ("elsewhere", FilmClaimFit::Elsewhere),
        ("nowhere", FilmClaimFit::Nowhere),
        ("opposite", FilmClaimFit::Opposite),
    ];
    for (name, is_kind) in kinds {
        let own: Vec<FilmClaimFit> =
            filmed.claims.iter().zip(fits).filter(|(claim, _)| is_kind(&claim.kind)).map(|(_, fit)| *fit).collect();
        for (way, wanted) in ways {
            add_count(&format!("{name} {way}"), own.iter().filter(|fit| **fit == wanted).count(), features);
        }
        let decided = own.iter().filter(|fit| **fit != FilmClaimFit::Unknown).count();
        let lacking = own
            .iter()
            .filter(|fit| matches!(fit, FilmClaimFit::Elsewhere | FilmClaimFit::Nowhere | FilmClaimFit::Opposite))
            .count();
        if decided > 0 {
            add_steps(
                &format!("{name} lacking"),
                lacking as f64 / decided as f64,
                &[0.15, 0.3, 0.45, 0.6, 0.8],
                features,
            );
        }
    }
}

fn is_room(kind: &FilmClaimKind) -> bool {
    matches!(kind, FilmClaimKind::Place { meanings, .. } if meanings.first().is_some_and(|(is_room, _)| *is_room))
}

/// Whether a claim names a thing that few places have: two walks hardly share it by chance.
fn is_rare_thing(kind: &FilmClaimKind) -> bool {
    let FilmClaimKind::Place { meanings, .. } = kind else { return false };
    meanings.first().is_some_and(|(is_room, name)| {
        !is_room && find_thing(name).is_some_and(|thing| thing.salience >= RARE_SALIENCE)
    })
}

/// Things of at least this salience catch the eye, and are few.
const RARE_SALIENCE: u8 = 3;

/// By how much the largest shift of a part's end from its share of the words is, as a share of the walk.
fn largest_shift(filmed: &FilmedText<'_>, stretches: &[[usize; 2]]) -> f64 {
    let ends = stretches.iter().enumerate().take(stretches.len().saturating_sub(1));
    let shifts = ends.map(|(part, stretch)| (filmed.way_share(stretch[1]) - filmed.word_share(part + 1)).abs());
    shifts.fold(0.0, f64::max)
}

fn untold_turns(filmed: &FilmedText<'_>, stretches: &[[usize; 2]]) -> usize {
    let tells_turn = |part: usize| {
        let is_turn = |kind: &FilmClaimKind| matches!(kind, FilmClaimKind::Turn { .. } | FilmClaimKind::Around);
        filmed.claims.iter().any(|claim| claim.part == part && is_turn(&claim.kind))
    };
    let untold = stretches.iter().enumerate().filter(|(part, _)| !tells_turn(*part));
    untold.map(|(_, stretch)| filmed.count_large_turns(*stretch)).sum()
}

/// Whether what the first and the last part name was seen where they belong.
fn add_end(filmed: &FilmedText<'_>, fits: &[FilmClaimFit], features: &mut Vec<(String, f64)>) {
    let last = filmed.text.parts.len() - 1;
    for (name, part) in [("start", 0), ("end", last)] {
        let own = filmed.claims.iter().zip(fits).filter(|(claim, _)| claim.part == part);
        let places: Vec<FilmClaimFit> = own
            .filter(|(claim, _)| matches!(claim.kind, FilmClaimKind::Place { .. }))
            .map(|(_, fit)| *fit)
            .filter(|fit| *fit != FilmClaimFit::Unknown)
            .collect();
        let seen = places.iter().filter(|fit| matches!(fit, FilmClaimFit::Fits | FilmClaimFit::Perhaps)).count();
        let word = match (seen, places.len()) {
            (_, 0) => "unknown",
            (0, _) => "unseen",
            (seen, all) if seen < all => "partly seen",
            _ => "seen",
        };
        features.push((format!("{name} {word}"), 1.0));
    }
}

/// Adds a feature for each number up to the count.
fn add_count(name: &str, count: usize, features: &mut Vec<(String, f64)>) {
    features.extend((1..=count.min(MOST_COUNTED)).map(|number| (format!("{name} {number}"), 1.0)));
}

/// Adds a feature for each limit that a value reaches.
fn add_steps(name: &str, value: f64, limits: &[f64], features: &mut Vec<(String, f64)>) {
    features.extend(limits.iter().filter(|limit| value >= **limit).map(|limit| (format!("{name} {limit}"), 1.0)));
}
