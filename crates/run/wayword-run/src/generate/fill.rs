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
    /// The items and styles of the run.
    pub(super) plan: &'a RunPlan<'a>,
    /// The settings as the run folder keeps them.
    pub(super) settings: &'a RunSettings,
    /// The models; `None` if none takes part.
    pub(super) calls: Option<&'a ModelCalls>,
    /// The players of the roles.
    pub(super) team: &'a RoleTeam,
    /// The scenes that were surveyed so far.
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
        let style_texts = |measured: &MeasuredStyle| {
            let style = measured.style.name.clone();
            (0..self.settings.per_path).map(move |number| text_name(&style, number))
        };
        let names: Vec<String> = styles.iter().flat_map(style_texts).collect();
        let unfinished = run.items_left(items, &names);
        if unfinished.len() < items.len() {
            let done = items.len() - unfinished.len();
            let (all, left) = (count_phrase(items.len(), "item"), unfinished.len());
            output.say(format_args!("continuing: {done} of {all} done and kept, {left} to do"));
        }
        let mut progress = RunProgress::new(output, items.len(), unfinished.len(), self.calls, self.team.lookout());
        self.make_items(run, data, &unfinished, &mut progress)?;
        run.arrange_lines(items.iter(), &names)?;
        run.sync()?;
        Ok(progress.into_stop())
    }

    /// Makes the unfinished items on several threads, and keeps each in the folder in the order of the items, until the
    /// progress ends the run.
    fn make_items(
        &self,
        run: &mut RunFolder,
        data: &WorldData,
        unfinished: &[&RunItem],
        progress: &mut RunProgress<'_>,
    ) -> Result<(), CommandError> {
        let (calls, styles) = (self.calls, &self.plan.styles);
        let workers = calls.map_or_else(core_count, ModelCalls::worker_count);
        let expected = if calls.is_some() { self.plan.calls_per_item(unfinished, self.team.lookout())? } else { 0.0 };
        let pace = CallPace::new(unfinished.len(), workers, expected);
        let world = RunPlatform { platform: self.plan.platform, data: Some(data), scenes: &self.scenes };
        let unmade = AtomicUsize::new(unfinished.len());
        let making = |item: &RunItem| {
            interrupt::check_interrupt()?;
            let threads = calls.map_or(1, |calls| calls.views_at_once(unmade.load(Ordering::Relaxed)));
            let made = make_item(item, self.settings, world, self.team, styles, threads);
            unmade.fetch_sub(1, Ordering::Relaxed);
            made
        };
        // The threads that make items take over the span and the subscriber of this thread.
        let call_context = CallContext::from_current_thread();
        let making = |item: &&RunItem| {
            call_context.run_within(|| {
                let mut span = ItemSpan::begin(item);
                (span.make_within(|| making(item)), span)
            })
        };
        let bar = progress.progress_bar();
        thread::scope(|scope| {
            if let Some(calls) = calls {
                let (pace, bar) = (&pace, &bar);
                scope.spawn(move || {
                    pace.watch_calls(|| calls.spent_so_far(), |text| bar.set_message(text.to_owned()));
                });
            }
            let kept = in_order(unfinished, workers, making, |item, (made, span)| {
                let fate = keep_item(run, world, item, made, styles)?;
                span.end_with(&fate);
                pace.item_is_done();
                progress.count_item(run, fate)
            });
            pace.end_watch();
            kept
        })
    }
}
