//! How much of an untrusted file is believed.

/// Largest file, in bytes: as it lies on the disk, and again after gunzip. RxR's largest is about 0.3 GB.
pub(crate) const FILE_BYTES: u64 = 1 << 30;
/// Most items in a file. R2R's largest augmentation has about a million.
pub(crate) const ITEMS: usize = 2_000_000;
/// Most JSON values within one item; without it, a small file of zeros becomes a tree forty times its size.
pub(crate) const VALUES_PER_ITEM: usize = 200_000;
/// Longest line of a JSON Lines file, bytes.
pub(crate) const LINE_BYTES: usize = 16 << 20;
/// Most nodes or positions of one path.
pub(crate) const PATH_NODES: usize = 1_000;
/// Longest instruction, bytes.
pub(crate) const INSTRUCTION_BYTES: usize = 20_000;
/// Most instructions of one item.
pub(crate) const INSTRUCTIONS: usize = 1_000;
/// Longest name (of a path, an item, a split), bytes.
pub(crate) const NAME_BYTES: usize = 128;
