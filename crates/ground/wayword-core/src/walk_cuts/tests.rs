use super::*;
use crate::seeded_rng;
use rand::Rng;

/// All ways to cut a walk between a place and its last place into consecutive stretches, listed one by one.
fn all_cuts(parts: usize, places: usize, from: usize) -> Vec<Vec<[usize; 2]>> {
    if parts == 0 {
        return if from + 1 == places { vec![Vec::new()] } else { Vec::new() };
    }
    let mut cuts = Vec::new();
    for to in from..places {
        for rest in all_cuts(parts - 1, places, to) {
            cuts.push([vec![[from, to]], rest].concat());
        }
    }
    cuts
}

/// Scores without any pattern. A pair of places that is no stretch has a high one, which must not count.
fn random_scores(seed: u64, parts: usize, places: usize) -> Vec<Vec<f64>> {
    let mut random = seeded_rng(seed, &["cuts"]);
    let mut score = |at: usize| if at / places > at % places { 50.0 } else { random.random_range(-2.0..2.0) };
    (0..parts).map(|_| (0..places * places).map(&mut score).collect()).collect()
}

fn cut_score(scores: &[Vec<f64>], places: usize, cut: &[[usize; 2]]) -> f64 {
    scores.iter().zip(cut).map(|(scores, [from, to])| scores[from * places + to]).sum()
}

/// Infinities are near to themselves.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9 || a == b
}

#[test]
fn walk_cuts_agree_with_the_list_of_all_cuts() {
    for seed in 0..5 {
        for (parts, places) in (1..=4).flat_map(|parts| (1..=5).map(move |places| (parts, places))) {
            let scores = random_scores(seed, parts, places);
            let listed = all_cuts(parts, places, 0);
            let score = |cut: &Vec<[usize; 2]>| cut_score(&scores, places, cut);
            let whole: f64 = listed.iter().map(|cut| score(cut).exp()).sum();
            let share = |fits: &dyn Fn(&Vec<[usize; 2]>) -> bool| {
                listed.iter().filter(|cut| fits(cut)).map(|cut| score(cut).exp()).sum::<f64>() / whole
            };
            let cuts = WalkCuts::new(scores.clone(), places);
            let case = format!("seed {seed}, {parts} parts, {places} places");
            assert!(near(cuts.total(), whole.ln()), "{case}: {} {}", cuts.total(), whole.ln());
            let best = listed.iter().max_by(|a, b| score(a).total_cmp(&score(b))).unwrap();
            assert_eq!(cuts.best_cut(), *best, "{case}");
            for part in 0..parts {
                for stretch in (0..places).flat_map(|from| (from..places).map(move |to| [from, to])) {
                    let expected = share(&|cut| cut[part] == stretch);
                    assert!(near(cuts.stretch_share(part, stretch), expected), "{case}: {part} {stretch:?}");
                }
                for (end, stretch) in (part + 1..=parts).flat_map(|end| all_stretches(places).map(move |at| (end, at)))
                {
                    let expected = share(&|cut| [cut[part][0], cut[end - 1][1]] == stretch);
                    assert!(near(cuts.joint_share(part..end, stretch), expected), "{case}: {part} {end} {stretch:?}");
                }
                let ends = cuts.end_shares(part);
                assert_eq!(ends.len(), places, "{case}");
                for (place, end) in ends.iter().enumerate() {
                    assert!(near(*end, share(&|cut| cut[part][1] == place)), "{case}: {part} {place}");
                }
            }
        }
    }
}

#[test]
fn shares_of_a_part_add_up_to_one() {
    for (parts, places) in [(1, 1), (1, 6), (3, 4), (6, 3), (9, 12)] {
        let cuts = WalkCuts::new(random_scores(7, parts, places), places);
        for part in 0..parts {
            let stretches: f64 = all_stretches(places).map(|stretch| cuts.stretch_share(part, stretch)).sum();
            let ends: f64 = cuts.end_shares(part).iter().sum();
            assert!(near(stretches, 1.0) && near(ends, 1.0), "{parts} {places} {part}: {stretches} {ends}");
        }
        assert!(near(cuts.end_shares(parts - 1)[places - 1], 1.0), "the last part ends where the walk does");
    }
}

#[test]
fn all_stretches_go_from_each_place_to_itself_and_each_later_one() {
    assert_eq!(all_stretches(3).collect::<Vec<_>>(), [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]]);
    let mut indices: Vec<usize> = all_stretches(4).map(|stretch| stretch_index(4, stretch)).collect();
    indices.dedup();
    assert!(indices.len() == 10 && indices.iter().all(|index| *index < 16));
    assert_eq!([[0, 2], [1, 1], [2, 3]].map(|stretch| stretch_index(4, stretch)), [2, 5, 11]);
}

#[test]
fn a_walk_of_one_place_has_one_cut() {
    let cuts = WalkCuts::new(vec![vec![0.5], vec![-2.0], vec![1.0]], 1);
    assert!(near(cuts.total(), -0.5));
    assert_eq!(cuts.best_cut(), [[0, 0]; 3]);
    for part in 0..3 {
        assert!(near(cuts.stretch_share(part, [0, 0]), 1.0) && near(cuts.end_shares(part)[0], 1.0));
    }
}

#[test]
fn a_stretch_that_is_ruled_out_has_no_share() {
    let mut scores = random_scores(3, 2, 3);
    scores[0][stretch_index(3, [0, 1])] = f64::NEG_INFINITY;
    let cuts = WalkCuts::new(scores, 3);
    let ends = cuts.end_shares(0);
    assert!(ends[1] == 0.0 && near(ends[0] + ends[2], 1.0), "{ends:?}");
    assert_eq!(cuts.stretch_share(1, [1, 2]), 0.0);
}

#[test]
fn a_constant_added_to_all_scores_changes_only_the_total() {
    let scores = random_scores(4, 3, 4);
    let higher: Vec<Vec<f64>> = scores.iter().map(|part| part.iter().map(|score| score + 1000.0).collect()).collect();
    let [plain, higher] = [scores, higher].map(|scores| WalkCuts::new(scores, 4));
    assert!((higher.total() - plain.total() - 3000.0).abs() < 1e-6, "{} {}", higher.total(), plain.total());
    assert_eq!(higher.best_cut(), plain.best_cut());
    let mut ends = plain.end_shares(1).into_iter().zip(higher.end_shares(1));
    assert!(ends.all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn log_sum_adds_numbers_given_by_their_logs() {
    assert!(near(log_sum(2.0f64.ln(), 3.0f64.ln()), 5.0f64.ln()));
    assert!(near(log_sum(3.0f64.ln(), 2.0f64.ln()), 5.0f64.ln()));
    assert!(near(log_sum(0.25f64.ln(), 0.25f64.ln()), 0.5f64.ln()));
    assert!(near(log_sum(f64::NEG_INFINITY, 1.5), 1.5) && near(log_sum(1.5, f64::NEG_INFINITY), 1.5));
    assert_eq!(log_sum(f64::NEG_INFINITY, f64::NEG_INFINITY), f64::NEG_INFINITY);
    assert!(near(log_sum(-1000.0, 1000.0), 1000.0));
}
