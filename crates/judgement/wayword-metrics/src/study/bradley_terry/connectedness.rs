//! Checks that choices determine finite strengths. They do if and only if every system can be reached from every other along
//! choices that were won or tied (Ford 1957; Davidson 1970 for ties). Otherwise some group of systems was never beaten, and its
//! strength would be infinite.

use super::NoStrength;
use super::fit::{ChoiceOutcome, SystemPair};
use std::fmt::Display;

/// Reports why the choices determine no finite strengths, if that is so. `systems` are the names of the systems by number.
pub(super) fn check_connected<S: Display>(pairs: &[SystemPair], systems: &[&S]) -> Result<(), NoStrength> {
    let names = |is_named: &dyn Fn(usize) -> bool| -> Vec<String> {
        systems.iter().enumerate().filter(|(at, _)| is_named(*at)).map(|(_, system)| system.to_string()).collect()
    };
    if pairs.is_empty() {
        return Err(NoStrength::NoChoices);
    }
    let groups = connected_groups(pairs, systems.len());
    let count = groups.iter().max().map_or(0, |highest| highest + 1);
    if count > 1 {
        let groups = (0..count).map(|group| names(&|at| groups[at] == group)).collect();
        return Err(NoStrength::Unconnected { groups });
    }
    if pairs.iter().all(|pair| pair.outcome == ChoiceOutcome::Tie) {
        return Err(NoStrength::OnlyTies);
    }
    for from in 0..systems.len() {
        // From a system to those that lost to it or tied, and on from there.
        let reached = reachable_systems(pairs, systems.len(), from, |pair| match pair.outcome {
            ChoiceOutcome::First => (true, false),
            ChoiceOutcome::Second => (false, true),
            ChoiceOutcome::Tie => (true, true),
        });
        if reached.contains(&false) {
            return Err(NoStrength::Separated { above: names(&|at| !reached[at]), below: names(&|at| reached[at]) });
        }
    }
    Ok(())
}

/// The number of the group of each system. Systems are in one group if a chain of choices connects them, however they ended.
fn connected_groups(pairs: &[SystemPair], systems: usize) -> Vec<usize> {
    let mut groups = vec![usize::MAX; systems];
    let mut count = 0;
    for from in 0..systems {
        if groups[from] == usize::MAX {
            let reached = reachable_systems(pairs, systems, from, |_| (true, true));
            groups.iter_mut().zip(reached).filter(|(_, is_in)| *is_in).for_each(|(group, _)| *group = count);
            count += 1;
        }
    }
    groups
}

/// Which systems can be reached from `from`. `ways` returns whether a choice leads from its first system to its second, and back.
fn reachable_systems(
    pairs: &[SystemPair],
    systems: usize,
    from: usize,
    ways: impl Fn(&SystemPair) -> (bool, bool),
) -> Vec<bool> {
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); systems];
    for pair in pairs {
        let (there, back) = ways(pair);
        if there {
            next[pair.first].push(pair.second);
        }
        if back {
            next[pair.second].push(pair.first);
        }
    }
    let mut reached = vec![false; systems];
    let mut frontier = vec![from];
    while let Some(at) = frontier.pop() {
        if !std::mem::replace(&mut reached[at], true) {
            frontier.extend(&next[at]);
        }
    }
    reached
}
