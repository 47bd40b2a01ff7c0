//! Numbers the viewpoints of a scene, and looks them up by name. Figures are computed over these numbers.

use wayword_core::ViewpointId;

/// The viewpoints of a scene, numbered in the order of their names.
///
/// Looking up names is the most frequent operation here. Searching their first bytes as numbers is quicker than hashing
/// whole names, and no choice of names can make it slow.
#[derive(Debug, Clone)]
pub(super) struct NumberedViewpoints {
    /// The first bytes of each name, as a number that sorts as they do.
    heads: Vec<u64>,
    /// The bytes after the head of each name, so that short names are compared without following a pointer. Long names have here
    /// 255 in every byte, which is not valid UTF-8 and so equals no name.
    tails: Vec<[u8; TAIL_BYTES]>,
    /// The names, in order.
    names: Vec<ViewpointId>,
}

/// Bytes of the head and of the tail of a name: together the length of Matterport3D's names, 32.
const HEAD_BYTES: usize = 8;
const TAIL_BYTES: usize = 24;

impl NumberedViewpoints {
    pub(super) fn new<'a>(names: impl Iterator<Item = &'a ViewpointId>) -> Self {
        let mut names: Vec<ViewpointId> = names.cloned().collect();
        names.sort_unstable();
        let heads = names.iter().map(|name| head_number(name.as_str())).collect();
        let tail = |name: &ViewpointId| {
            if is_short(name.as_str()) { tail_bytes(name.as_str()) } else { [u8::MAX; TAIL_BYTES] }
        };
        Self { heads, tails: names.iter().map(tail).collect(), names }
    }

    pub(super) fn len(&self) -> usize {
        self.names.len()
    }

    /// The name of viewpoint number `place`.
    pub(super) fn name(&self, place: usize) -> &ViewpointId {
        &self.names[place]
    }

    /// The number of a viewpoint; `None` if the scene lacks it.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        let head = head_number(name);
        let first = self.heads.partition_point(|other| *other < head);
        // A short name, padded with zeros, equals a full-length name that ends in zeros. Real names contain no zeros.
        if is_short(name) && *self.heads.get(first)? == head && self.tails[first] == tail_bytes(name) {
            return Some(first);
        }
        // Names may begin alike.
        let alike = self.heads[first..].partition_point(|other| *other == head);
        let names = &self.names[first..first + alike];
        names.binary_search_by(|other| other.as_str().cmp(name)).ok().map(|at| first + at)
    }
}

/// Whether head and tail contain the whole name, so that comparing them is enough. A shorter name with a zero in it could equal
/// another one that is padded with zeros.
fn is_short(name: &str) -> bool {
    name.len() == HEAD_BYTES + TAIL_BYTES || name.len() < HEAD_BYTES + TAIL_BYTES && !name.as_bytes().contains(&0)
}

/// The first bytes of a name as a number.
fn head_number(name: &str) -> u64 {
    u64::from_be_bytes(zero_padded::<HEAD_BYTES>(name.as_bytes()))
}

/// The bytes after the head, filled up with zeros.
fn tail_bytes(name: &str) -> [u8; TAIL_BYTES] {
    zero_padded(name.as_bytes().get(HEAD_BYTES..).unwrap_or_default())
}

/// The first bytes, filled up with zeros.
fn zero_padded<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or_else(|| {
        let mut filled = [0; N];
        filled[..bytes.len()].copy_from_slice(bytes);
        filled
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Names of few letters, of which many begin alike, and some are the beginning of others.
        #[test]
        fn find_returns_the_sorted_position_of_known_names_only(
            names in prop::collection::btree_set("[ab]{0,3}(long_head)?(and_a_tail_of_32_bytes)?[ab]{1,4}", 0..40),
            other in "[ab]{0,3}(long_head)?(and_a_tail_of_32_bytes)?[ab]{1,4}",
        ) {
            let ids: Vec<ViewpointId> = names.iter().rev().map(|name| ViewpointId::new(name).unwrap()).collect();
            let places = NumberedViewpoints::new(ids.iter());
            prop_assert_eq!(places.len(), names.len());
            for (at, name) in names.iter().enumerate() {
                prop_assert_eq!(places.find(name), Some(at));
            }
            prop_assert_eq!(places.find(&other).is_some(), names.contains(&other));
        }
    }
}
