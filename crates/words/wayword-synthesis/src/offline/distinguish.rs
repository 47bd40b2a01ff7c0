//! How a target differs from other objects of its name, by ground truth.

use wayword_core::{Distinction, Frame, Label, Side, Target, View};
use wayword_language::lexicon::{Class, agree, thing};

/// A neighbour has to be this near to the target, metres.
const NEAR_M: f64 = 1.5;
/// The target has to be nearer than this share of the distance of every other object of its name.
const CLEARLY: f64 = 0.7;

/// Fills in how `target` differs from the other objects of its name that are seen from the last frame; `views` is the
/// panorama there. Without labels nothing is filled in.
pub fn distinguish(target: &mut Target, last: &Frame, views: &[View]) {
    let labels: Vec<&Label> = views.iter().filter_map(View::ground_truth).flat_map(|truth| &truth.labels).collect();
    let Some(own) = labels.iter().find(|label| label.object == target.object) else { return };
    let likes: Vec<&Label> = labels
        .iter()
        .filter(|label| label.object != target.object && agree(&label.name, &target.name))
        .copied()
        .collect();
    target.has_namesake = !likes.is_empty();
    target.told_by = by_colour(own, &likes)
        .into_iter()
        .chain(by_neighbour(own, &likes, &labels))
        .chain(by_side(own, &likes, last))
        .chain(by_range(own, &likes))
        .collect();
}

fn by_colour(own: &Label, likes: &[&Label]) -> Option<Distinction> {
    let colour = own.colour.clone()?;
    let alone = likes.iter().all(|like| like.colour.as_ref().is_some_and(|other| *other != colour));
    alone.then_some(Distinction::Colour { colour })
}

fn by_side(own: &Label, likes: &[&Label], last: &Frame) -> Option<Distinction> {
    let turn_deg = |label: &Label| last.pose.heading.turn_to(label.heading).to_degrees();
    let side = match turn_deg(own) {
        deg if (20.0..160.0).contains(&deg) => Side::Right,
        deg if (20.0..160.0).contains(&-deg) => Side::Left,
        _ => return None,
    };
    // No other object of its name may count as being on that side, even roughly.
    let elsewhere = |like: &&Label| {
        let deg = turn_deg(like) * if side == Side::Right { 1.0 } else { -1.0 };
        !(10.0..170.0).contains(&deg)
    };
    likes.iter().all(elsewhere).then_some(Distinction::OnSide { side })
}

fn by_neighbour(own: &Label, likes: &[&Label], labels: &[&Label]) -> Option<Distinction> {
    let here = own.position?;
    let unique = |name: &str| labels.iter().filter(|label| agree(&label.name, name)).count() == 1;
    let tells = |label: &&&Label| {
        thing(&label.name).is_some_and(|thing| {
            thing.salience >= 1 && !matches!(thing.class, Class::Structure | Class::Fabric | Class::Unknown)
        }) && label.object != own.object
            && !agree(&label.name, &own.name)
            && unique(&label.name)
    };
    let distances = labels.iter().filter(tells).filter_map(|label| {
        let there = label.position?;
        let own_m = there.distance(here);
        let likes_m = likes
            .iter()
            .map(|like| like.position.map_or(0.0, |position| there.distance(position)))
            .fold(f64::INFINITY, f64::min);
        (own_m <= NEAR_M && own_m <= CLEARLY * likes_m).then_some((own_m, label))
    });
    let (_, neighbour) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Distinction::NextTo { neighbour: neighbour.name.clone() })
}

fn by_range(own: &Label, likes: &[&Label]) -> Option<Distinction> {
    let own_m = own.distance_m?;
    let others: Option<Vec<f64>> = likes.iter().map(|like| like.distance_m).collect();
    let others = others.filter(|others| !others.is_empty())?;
    if others.iter().all(|other_m| own_m < CLEARLY * other_m) {
        return Some(Distinction::Range { nearest: true });
    }
    others.iter().all(|other_m| own_m * CLEARLY > *other_m).then_some(Distinction::Range { nearest: false })
}
