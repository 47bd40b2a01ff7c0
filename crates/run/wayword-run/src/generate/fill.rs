//! Makes the items that are missing in a run folder, in parallel, and keeps them in their order.

use super::{
    item_span::ItemSpan,
    keep::keep_item,
    pace::CallPace,
    progress::{RunProgress, RunStop},
};
use crate::{
    calls::ModelCalls,
    count::count_phrase,
    error::CommandError,
    follow::KnownScenes,
    in_order::{core_count, in_order},
    interrupt,
    item::RunItem,
    output::CommandOutput,
    pipeline::{RunPlatform, make_item},
    plan::RunPlan,
    run_folder::{RunFolder, WorldData, text_name},
    settings::RunSettings,
    styles::MeasuredStyle,
    team::RoleTeam,
};
use std::{
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};
use wayword_ledger::CallContext;

/// Everything that making items needs. It is opened once, however many folders (chunks) are filled with it.
pub(super) struct ItemWorkshop<'a> {
    pub(super) plan: &'a RunPlan<'a>,
    /// The settings as the run folder keeps them.
    pub(super) settings: &'a RunSettings,
    pub(super) calls: Option<&'a ModelCalls>,
    pub(super) team: &'a RoleTeam,
    pub(super) scenes: KnownScenes,
}

impl ItemWorkshop<'_> {
    /// Makes those of the items that the folder lacks, and puts its lines in order. Returns the reason if it stopped early.
    pub(super) fn fill_folder(
        &self,
        run: &mut RunFolder,
        data: &WorldData,
        items: &[RunItem],
        output: &CommandOutput,
    ) -> Result<Option<RunStop>, CommandError> {
        let styles = &self.plan.styles;
        let numbers = |measured: &MeasuredStyle| {
            let style = measured.style.name.clone();
            (0..self.settings.per_path).map(move |number| text_name(&style, number))
        };
        let names: Vec<String> = styles.iter().flat_map(numbers).collect();
        let left = run.items_left(items, &names);
        if left.len() < items.len() {
            let done = items.len() - left.len();
            let (all, left) = (count_phrase(items.len(), "item"), left.len());
            output.say(format_args!("continuing: {done} of {all} done and kept, {left} to do"));
        }
        let mut progress = RunProgress::new(output, items.len(), left.len(), self.calls, self.team.lookout());
        let kept = self.make_items(run, data, &left, &mut progress, items.len(), output);
        kept?;
        run.arrange_lines(items.iter(), &names)?;
        run.sync()?;
        Ok(progress.into_stop())
    }

    fn make_items(
        &self,
        run: &mut RunFolder,
        data: &WorldData,
        left: &[&RunItem],
        progress: &mut RunProgress<'_>,
        all: usize,
        output: &CommandOutput,
    ) -> Result<(), CommandError> {
        let (calls, styles) = (self.calls, &self.plan.styles);
        let workers = calls.map_or_else(core_count, ModelCalls::worker_count);
        let expected = if calls.is_some() { self.plan.calls_per_item(left, self.team.lookout())? } else { 0.0 };
        let pace = CallPace::new(left.len(), workers, expected);
        let world = RunPlatform { platform: self.plan.platform, data: Some(data), scenes: &self.scenes };
        let unmade = AtomicUsize::new(left.len());
        let making = |item: &RunItem| {
            interrupt::check_interrupt()?;
            let threads = calls.map_or(1, |calls| calls.views_at_once(unmade.load(Ordering::Relaxed)));
            let made = make_item(item, self.settings, world, self.team, styles, threads);
            unmade.fetch_sub(1, Ordering::Relaxed);
            made
        };
        let occasion = CallContext::from_current_thread();
        let making = |item: &&RunItem| {
            occasion.run_within(|| {
                let mut span = ItemSpan::begin(item);
                (span.make_within(|| making(item)), span)
            })
        };
        let bar = progress.progress_bar();
        thread::scope(|scope| {
            if let Some(calls) = calls {
                let (pace, bar) = (&pace, &bar);
                let said = |told: &str| output.in_lines(format_args!("{}/{all} items, {told}", bar.position()));
                scope.spawn(move || {
                    pace.watch_calls(|| calls.spent_so_far(), |told| bar.set_message(told.to_owned()), said);
                });
            }
            let kept = in_order(left, workers, making, |item, (made, span)| {
                let fate = keep_item(run, world, item, made, styles)?;
                span.end_with(&fate);
                pace.item_is_done();
                progress.takes_note(run, fate)
            });
            pace.end_watch();
            kept
        })
    }
}
