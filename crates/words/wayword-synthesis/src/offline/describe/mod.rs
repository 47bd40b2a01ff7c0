//! Finds descriptions of a target that fit no other object of its building: properties that are added to its name and
//! the kind of its room ("the lamp above the desk").
//!
//! A rival is another object that could be called by the target's name. All subsets of up to three properties are
//! tried, after Dale and Reiter (1995). The cheapest subsets that fit no rival are kept; if every subset fits rivals,
//! those that fit fewest. The cost of a description is roughly the number of its words.

mod listing;
mod properties;
mod relations;
mod superlatives;
#[cfg(test)]
mod tests;

pub use listing::BuildingListing;

use properties::{TargetContext, TargetProperty};
use wayword_core::{Frame, ObjectDescription, ObjectDistinction, ObjectRelation, PathTarget};

/// Most descriptions of a target, the cheapest first; dearer ones are dropped.
const MAX_DESCRIPTIONS: usize = 32;
/// Most properties that are combined, the cheapest first; dearer ones are not tried.
const MAX_PROPERTIES: usize = 36;
/// Extra cost, in words, of a superlative ("the leftmost") where more objects of the kind exist than can be seen from
/// the end.
const UNCLEAR_SUPERLATIVE_COST: f64 = 1.2;
/// Cost, in words, of a second property of the object.
const SECOND_PROPERTY_COST: f64 = 1.0;
/// Cost, in words, of a property that is not needed to single the target out.
const IDLE_PROPERTY_COST: f64 = 1.0;

/// What a walker sees ahead so near to the end of the way belongs to the arrival, metres.
const APPROACH_M: f64 = 4.0;

/// The frames from which a walker sees ahead on arrival, the last first; none where the path ends at a viewpoint, whose panorama shows
/// what is all around.
pub fn approach_frames(frames: &[Frame]) -> impl Iterator<Item = &Frame> {
    let end = frames.last().filter(|last| last.viewpoint.is_none());
    let is_near =
        move |frame: &&Frame| end.is_some_and(|end| frame.pose.position.distance(end.pose.position) <= APPROACH_M);
    frames.iter().rev().take_while(is_near)
}

/// Fills in how a target can be described: for a listener at the last frame, who sees other objects of the same name
/// there, and for a listener who knows the whole building. `frames` are those of the path. Does nothing if the target is not listed.
pub fn describe_target(target: &mut PathTarget, frames: &[Frame], listing: &BuildingListing) {
    let place = frames.last().and_then(|last| listing.place_index(last));
    let (Some(own), Some(place)) = (listing.object_index(&target.object), place) else { return };
    let context = TargetContext::new(listing, frames, &listing.places[place], own);
    let mut properties = context.all_properties();
    properties.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    properties.truncate(MAX_PROPERTIES);
    let namesakes: Vec<bool> = context.rivals.iter().map(|rival| context.sight_of_object(*rival).is_some()).collect();
    target.has_namesake = namesakes.contains(&true);
    target.told_by = distinctions_in_view(&context, &properties, &namesakes);
    target.descriptions = search_descriptions(&context, &properties);
    if let Some(level) = context.level_of_room() {
        target.descriptions.iter_mut().for_each(|description| tell_level(description, level));
    }
    target.hangs = context.target_hangs();
    target.storeys = listing.storeys;
}

/// Adds the storey to a description: a person who hears of a bedroom goes to the first one.
fn tell_level(description: &mut ObjectDescription, level: u32) {
    if !description.tells_level() {
        description.by.insert(0, ObjectDistinction::Level { level });
    }
}

/// The single properties that no namesake in view has, the cheapest first.
fn distinctions_in_view(
    context: &TargetContext<'_>,
    properties: &[TargetProperty],
    namesakes: &[bool],
) -> Vec<ObjectDistinction> {
    let distinguishes = |property: &&TargetProperty| {
        !property.distinction.is_about_room()
            && !property.fits.iter().zip(namesakes).any(|(fits, in_view)| *fits && *in_view)
    };
    let mut told: Vec<(f64, ObjectDistinction)> =
        properties.iter().filter(distinguishes).map(|property| (property.cost, property.distinction.clone())).collect();
    if namesakes.contains(&true) {
        told.extend(context.superlatives_among(namesakes));
    }
    // A listener who hears "on the right" looks for the only one there.
    let is_clear =
        |told: &ObjectDistinction| !told.is_about_room() && !matches!(told, ObjectDistinction::OnSide { .. });
    if told.is_empty() {
        // No property excludes all namesakes: one that excludes most of them is better than none.
        let count = |fits: &[bool]| fits.iter().zip(namesakes).filter(|(fits, in_view)| **fits && **in_view).count();
        let all = namesakes.iter().filter(|in_view| **in_view).count();
        let of_object =
            properties.iter().filter(|property| is_clear(&property.distinction) && count(&property.fits) < all);
        told.extend(of_object.map(|property| (count(&property.fits) as f64, property.distinction.clone())));
    }
    if told.is_empty() {
        // A property that all of them share still narrows down where to look.
        let is_usable = |told: &ObjectDistinction| is_clear(told) || !told.is_about_room() && context.is_outermost();
        let of_object = properties.iter().filter(|property| is_usable(&property.distinction));
        told.extend(of_object.map(|property| (property.cost, property.distinction.clone())));
    }
    told.sort_by(|a, b| a.0.total_cmp(&b.0));
    told.into_iter().map(|(_, told)| told).collect()
}

/// A description in the making.
struct DescriptionCandidate {
    cost: f64,
    description: ObjectDescription,
}

/// The best descriptions among all combinations of up to three properties.
fn search_descriptions(context: &TargetContext<'_>, properties: &[TargetProperty]) -> Vec<ObjectDescription> {
    let base = context.rivals_in_kind();
    let mut found: Vec<DescriptionCandidate> = Vec::new();
    add_candidates(context, &[], &base, &mut found);
    for (first, a) in properties.iter().enumerate() {
        let left = both_true(&base, &a.fits);
        add_candidates(context, &[a], &left, &mut found);
        for (second, b) in properties.iter().enumerate().skip(first + 1) {
            let left = both_true(&left, &b.fits);
            add_candidates(context, &[a, b], &left, &mut found);
            if !left.contains(&true) {
                continue;
            }
            for c in &properties[second + 1..] {
                let left = both_true(&left, &c.fits);
                if !left.contains(&true) {
                    push_candidate(&[a, b, c], 0, None, &mut found);
                }
            }
        }
    }
    // If several are on one side, "the one on the left" means the leftmost.
    if !context.is_outermost() {
        let is_side = |by: &ObjectDistinction| matches!(by, ObjectDistinction::OnSide { .. });
        found.retain(|found| found.description.leaves == 1 || !found.description.by.iter().any(is_side));
    }
    best_descriptions(found)
}

/// For each rival, whether it passed both lists.
fn both_true(a: &[bool], b: &[bool]) -> Vec<bool> {
    a.iter().zip(b).map(|(a, b)| *a && *b).collect()
}

/// Adds a candidate with these properties alone, and candidates with a superlative among the namesakes in view. `left`
/// has the rivals that the properties fit too. The superlative ignores namesakes that cannot be seen from the end; that
/// is less clear, so it costs more.
fn add_candidates(
    context: &TargetContext<'_>,
    by: &[&TargetProperty],
    left: &[bool],
    found: &mut Vec<DescriptionCandidate>,
) {
    let count = |left: &[bool]| left.iter().filter(|left| **left).count();
    push_candidate(by, count(left), None, found);
    let in_view: Vec<bool> =
        left.iter().zip(&context.rivals).map(|(left, rival)| *left && context.is_seen_in_room(*rival)).collect();
    if in_view.contains(&true) {
        let elsewhere = count(left) - count(&in_view);
        let unclear = if elsewhere > 0 { UNCLEAR_SUPERLATIVE_COST } else { 0.0 };
        // Of a panorama, "the leftmost" is what its listener sees; a walker has passed others.
        let elsewhere = if context.has_panorama { 0 } else { elsewhere };
        for (cost, superlative) in context.superlatives_among(&in_view) {
            push_candidate(by, elsewhere, Some((cost + unclear, superlative)), found);
        }
    }
}

/// Adds a candidate, unless people would not say it so. `rest` is the number of rivals that it fits too.
fn push_candidate(
    by: &[&TargetProperty],
    rest: usize,
    superlative: Option<(f64, ObjectDistinction)>,
    found: &mut Vec<DescriptionCandidate>,
) {
    let cost = by.iter().map(|property| property.cost).sum::<f64>() + superlative.as_ref().map_or(0.0, |of| of.0);
    // Two properties of the object and two of its room are enough.
    let of_room = by.iter().filter(|property| property.distinction.is_about_room()).count();
    if of_room > 2 || by.len() + usize::from(superlative.is_some()) - of_room > 2 {
        return;
    }
    // "The bedroom with a plant with a wardrobe".
    let is_with = |told: &&&TargetProperty| matches!(told.distinction, ObjectDistinction::RoomWith { .. });
    if by.iter().filter(is_with).count() > 1 {
        return;
    }
    // No thing is mentioned twice in a description.
    let names = |at: usize| by[at].distinction.named_things();
    let repeats = (1..by.len()).any(|at| names(at).any(|name| (0..at).any(|before| names(before).any(|o| o == name))));
    if repeats {
        return;
    }
    // "The lamp next to the sofa near the window": which of the two stands near the window?
    let is_near = |told: &&&TargetProperty| {
        matches!(
            told.distinction,
            ObjectDistinction::NextTo { .. } | ObjectDistinction::Related { relation: ObjectRelation::Near, .. }
        )
    };
    if by.iter().filter(is_near).count() > 1 {
        return;
    }
    let of_object = |told: &&&TargetProperty| {
        !told.distinction.is_about_room() && !matches!(told.distinction, ObjectDistinction::Colour { .. })
    };
    let more = by.iter().filter(of_object).count() + usize::from(superlative.is_some());
    let has_side = by.iter().any(|property| matches!(property.distinction, ObjectDistinction::OnSide { .. }));
    // "The lamp by the sofa on the left": it is unclear which of the two is on the left, and likewise with "the farthest".
    if (has_side || superlative.is_some()) && more > 1 {
        return;
    }
    let cost = cost + if more > 1 { SECOND_PROPERTY_COST } else { 0.0 };
    let told = by.iter().map(|property| property.distinction.clone()).chain(superlative.map(|of| of.1));
    found.push(DescriptionCandidate { cost, description: ObjectDescription { by: told.collect(), leaves: rest + 1 } });
}

/// The cheapest descriptions that fit only the target; if there are none, those that fit the fewest objects.
fn best_descriptions(mut found: Vec<DescriptionCandidate>) -> Vec<ObjectDescription> {
    let least = found.iter().map(|found| found.description.leaves).min().unwrap_or(1);
    found.retain(|found| found.description.leaves == least);
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<DescriptionCandidate> = Vec::new();
    for mut candidate in found {
        let contains_other =
            |other: &DescriptionCandidate| other.description.by.iter().all(|by| candidate.description.by.contains(by));
        if kept.iter().any(contains_other) {
            candidate.cost += IDLE_PROPERTY_COST;
        }
        kept.push(candidate);
    }
    kept.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    kept.truncate(MAX_DESCRIPTIONS);
    kept.into_iter().map(|found| found.description).collect()
}
