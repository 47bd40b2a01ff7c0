//! Finds out beforehand that some workers of a run would have nothing to do.

use super::args::even_chunk;
use crate::{count::count_phrase, error::CommandError, generate::args::GenerateArgs, settings_file::read_settings};
use wayword_queue::ChunkPlan;

/// The items of a run, as they are cut into chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChunkedItems {
    /// Items of the run.
    pub items: usize,
    /// Items in a chunk.
    pub chunk: usize,
    /// Whether a plan has fixed the chunks already.
    pub is_planned: bool,
}

impl ChunkedItems {
    /// The items of a plan.
    #[must_use]
    pub fn of_plan(plan: &ChunkPlan) -> Self {
        Self { items: plan.items.len(), chunk: plan.chunk, is_planned: true }
    }

    /// The items of a command that workers are going to run, as far as they can be known here: those of its plan, or its random
    /// paths or episodes. `None` where they cannot, as where its files are on other machines.
    ///
    /// `workers` is the number of its workers, where each has a fixed part.
    ///
    /// # Errors
    /// When the plan cannot be read.
    pub fn of_command(args: &GenerateArgs, workers: Option<usize>) -> Result<Option<Self>, CommandError> {
        let plan = args.out.as_deref().map(ChunkPlan::find_plan).transpose()?.flatten();
        if let Some(plan) = plan {
            return Ok(Some(Self::of_plan(&plan)));
        }
        let Ok(file) = read_settings(args.config.as_deref()) else { return Ok(None) };
        let Ok(settings) = args.asked.clone().or_file(file).resolve() else { return Ok(None) };
        let items = match &settings.episodes {
            None => settings.paths,
            Some(file) => match wayword_formats::read_any_format(file) {
                Ok(episodes) => {
                    let scan = &settings.scan;
                    let is_asked = |scene: &str| scan.is_empty() || scan.iter().any(|name| name == scene);
                    episodes.iter().filter(|episode| is_asked(episode.scene.as_str())).count()
                }
                Err(_) => return Ok(None),
            },
        };
        let items = items.min(settings.limit.unwrap_or(usize::MAX));
        Ok(Some(Self { items, chunk: args.workers.chunk_items(items, workers), is_planned: false }))
    }

    fn chunk_count(self) -> usize {
        self.items.div_ceil(self.chunk.max(1))
    }

    /// A warning, if there are fewer chunks than workers.
    #[must_use]
    pub fn idle_warning(self, workers: usize) -> Option<String> {
        let chunks = self.chunk_count();
        let idle = workers.checked_sub(chunks).filter(|idle| *idle > 0 && self.items > 0)?;
        let even = even_chunk(self.items, workers);
        let has = format!(
            "warning: {} share {} of {}, so {} of them will have nothing to do",
            count_phrase(workers, "worker"),
            count_phrase(chunks, "chunk"),
            count_phrase(self.chunk.min(self.items), "item"),
            idle
        );
        Some(match (self.items < workers, self.is_planned) {
            (true, _) => format!("{has}\nhint: start at most {} workers, with --chunk 1", self.items),
            (false, false) => format!("{has}\nhint: with --chunk {even} for all of them each has work"),
            (false, true) => format!(
                "{has}\nhint: the plan of the run has fixed its chunks; with --chunk {even} and another --out for all of them each \
                 has work"
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(items: usize, chunk: usize) -> ChunkedItems {
        ChunkedItems { items, chunk, is_planned: false }
    }

    #[test]
    fn fewer_chunks_than_workers_are_told_with_a_number_that_gives_each_worker_work() {
        let told = items(60, 64).idle_warning(2).unwrap();
        assert!(told.contains("2 workers share 1 chunk of 60 items, so 1 of them"), "{told}");
        assert!(told.contains("--chunk 30 "), "{told}");
        let planned = ChunkedItems { is_planned: true, ..items(60, 64) }.idle_warning(2).unwrap();
        assert!(planned.contains("--chunk 30 and another --out"), "{planned}");
        assert!(items(3, 64).idle_warning(5).unwrap().contains("at most 3 workers, with --chunk 1"));
        for enough in [items(65, 64).idle_warning(2), items(60, 64).idle_warning(1), items(0, 64).idle_warning(4)] {
            assert_eq!(enough, None);
        }
    }

    #[test]
    fn the_number_that_is_told_works_for_every_run() {
        for all in 1..200 {
            for workers in 2..=all {
                let Some(told) = items(all, 1000).idle_warning(workers) else { continue };
                let (_, rest) = told.split_once("--chunk ").unwrap();
                let chunk = rest.split(' ').next().unwrap().parse().unwrap();
                assert_eq!(items(all, chunk).idle_warning(workers), None, "{all} items, {workers} workers: {told}");
            }
        }
    }
}
