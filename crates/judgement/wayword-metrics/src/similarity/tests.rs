//! Tests of the similarity of sets: small examples, and properties that hold for any texts.

use super::*;
use proptest::prelude::*;

const DRAWING: ResamplingOptions = ResamplingOptions { resamples: 200, level: 0.95, seed: 5 };

/// Items as (id, path, vectors).
type Items = Vec<(u8, u8, Vec<Vec<f32>>)>;

fn set(items: &Items) -> BTreeMap<String, ItemVectors<'_>> {
    fn said(path: u8, vectors: &[Vec<f32>]) -> ItemVectors<'_> {
        ItemVectors { cluster: format!("p{path}"), vectors: vectors.iter().map(Vec::as_slice).collect() }
    }
    items.iter().map(|(id, path, vectors)| (format!("i{id}"), said(*path, vectors))).collect()
}

fn mean_of(estimate: Option<MeanEstimate>) -> f64 {
    estimate.unwrap().mean
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

const EAST: [f32; 2] = [1.0, 0.0];
const NORTH: [f32; 2] = [0.0, 1.0];

/// An item on a path of its own.
fn item<const N: usize>(id: u8, vectors: [[f32; 2]; N]) -> (u8, u8, Vec<Vec<f32>>) {
    (id, id, vectors.iter().map(|vector| vector.to_vec()).collect())
}

#[test]
fn an_item_is_the_mean_of_its_pairs_and_the_set_the_mean_of_its_items() {
    let a = vec![item(1, [EAST]), item(2, [EAST])];
    // Item 1: three of its four pairs of texts agree. Item 2: its only pair does not.
    let b = vec![item(1, [EAST, EAST, EAST, NORTH]), item(2, [NORTH])];
    let found = compare_sets(&set(&a), &set(&b), &DRAWING);
    assert!(near(mean_of(found.figure), (0.75 + 0.0) / 2.0));
    // Of six pairs of item 1's texts three agree; item 2 has no pair.
    assert!(near(mean_of(found.same_item), 0.5));
    assert_eq!((found.same_item.unwrap().values, found.single_in_b), (1, 1));
    // Item 1 against item 2's only text, and the other way.
    assert!(near(mean_of(found.random_pairs), 0.25));
}

#[test]
fn similarity_counts_and_leaves_out_items_of_one_side() {
    let a = vec![item(1, [EAST]), item(2, [EAST]), item(3, [])];
    let b = vec![item(2, [EAST]), item(3, [EAST]), item(4, [EAST])];
    let found = compare_sets(&set(&a), &set(&b), &DRAWING);
    assert_eq!((found.only_in_a, found.only_in_b, found.figure.unwrap().values), (1, 2, 1));
}

#[test]
fn similarity_is_none_without_common_items_or_pairs() {
    let of = |id| vec![item(id, [EAST])];
    let apart = compare_sets(&set(&of(1)), &set(&of(2)), &DRAWING);
    assert_eq!((apart.figure, apart.same_item, apart.random_pairs), (None, None, None));
    let alone = compare_sets(&set(&of(1)), &set(&of(1)), &DRAWING);
    assert!(alone.figure.is_some() && alone.random_pairs.is_none(), "one path has no other");
}

#[test]
fn random_pairs_never_lie_on_one_path() {
    // Texts about one path have a cosine of 1, texts about different paths one of 0.
    let axis = |at: usize| (0..4).map(|other| if other == at { 1.0 } else { 0.0 }).collect::<Vec<f32>>();
    let items: Items = (0..12).map(|id| (id, id % 4, vec![axis(usize::from(id % 4))])).collect();
    let found = compare_sets(&set(&items), &set(&items), &DRAWING);
    assert!(near(mean_of(found.figure), 1.0) && near(mean_of(found.random_pairs), 0.0), "{found:?}");
}

fn vectors() -> impl Strategy<Value = Vec<Vec<f32>>> {
    prop::collection::vec(prop::collection::vec(-1.0..1.0f32, 3), 0..4)
}

fn items() -> impl Strategy<Value = Items> {
    prop::collection::btree_map(0..12u8, vectors(), 0..10)
        .prop_map(|items| items.into_iter().map(|(id, vectors)| (id, id / 3, vectors)).collect())
}

proptest! {
    #[test]
    fn similarity_figure_is_symmetric(a in items(), b in items()) {
        let (ab, ba) = (compare_sets(&set(&a), &set(&b), &DRAWING), compare_sets(&set(&b), &set(&a), &DRAWING));
        prop_assert_eq!(ab.figure.is_some(), ba.figure.is_some());
        if let (Some(ab), Some(ba)) = (ab.figure, ba.figure) {
            prop_assert!(near(ab.mean, ba.mean) && near(ab.low, ba.low) && near(ab.high, ba.high));
        }
        prop_assert_eq!((ab.only_in_a, ab.only_in_b), (ba.only_in_b, ba.only_in_a));
    }

    #[test]
    fn every_figure_is_a_cosine_within_its_interval(a in items(), b in items()) {
        let found = compare_sets(&set(&a), &set(&b), &DRAWING);
        for estimate in [found.figure, found.same_item, found.random_pairs].into_iter().flatten() {
            prop_assert!(-1.0 <= estimate.low && estimate.high <= 1.0, "{estimate:?}");
            prop_assert!(estimate.low - 1e-9 <= estimate.mean && estimate.mean <= estimate.high + 1e-9, "{estimate:?}");
        }
    }

    #[test]
    fn the_same_texts_are_fully_alike(mut a in items()) {
        for (_, _, vectors) in &mut a {
            vectors.truncate(1);
            vectors.retain(|vector| vector.iter().any(|number| number.abs() > 1e-3));
        }
        if let Some(figure) = compare_sets(&set(&a), &set(&a), &DRAWING).figure {
            prop_assert!(near(figure.mean, 1.0) && near(figure.low, 1.0));
        }
    }

    #[test]
    fn the_order_of_texts_does_not_matter(a in items(), b in items()) {
        let turned: Items =
            b.iter().map(|(id, path, vectors)| (*id, *path, vectors.iter().rev().cloned().collect())).collect();
        let (found, turned) = (compare_sets(&set(&a), &set(&b), &DRAWING), compare_sets(&set(&a), &set(&turned), &DRAWING));
        for (found, turned) in [(found.figure, turned.figure), (found.same_item, turned.same_item)] {
            prop_assert_eq!(found.is_some(), turned.is_some());
            prop_assert!(found.zip(turned).is_none_or(|(a, b)| near(a.mean, b.mean)));
        }
    }

    #[test]
    fn the_length_of_vectors_does_not_matter(a in items(), b in items(), scale in 0.1..10.0f32) {
        let scaled: Items = b
            .iter()
            .map(|(id, path, vectors)| {
                (*id, *path, vectors.iter().map(|vector| vector.iter().map(|n| n * scale).collect()).collect())
            })
            .collect();
        let (found, scaled) = (compare_sets(&set(&a), &set(&b), &DRAWING), compare_sets(&set(&a), &set(&scaled), &DRAWING));
        prop_assert!(found.figure.zip(scaled.figure).is_none_or(|(a, b)| (a.mean - b.mean).abs() < 1e-4));
    }
}
