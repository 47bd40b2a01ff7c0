//! Makes the items that are missing in a run folder, in parallel, and keeps them in their order.

use super::{
    item_span::ItemSpan,
    keep::keep,
    pace::Pace,
    progress::{Progress, Stop},
};
use crate::{
    calls::Calls,
    count::count,
    error::Error,
    follow::KnownScenes,
    in_order::{cores, in_order},
    interrupt,
    item::Item,
    output::Output,
    pipeline::{RunPlatform, make},
    plan::Plan,
    run_folder::{RunFolder, WorldData, text_name},
    settings::Settings,
    styles::Measured,
    team::Team,
};
use std::{
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};
use wayword_ledger::Occasion;

/// Everything that making items needs. It is opened once, however many folders (chunks) are filled with it.
pub(super) struct Workshop<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// The settings as the run folder keeps them.
    pub(super) settings: &'a Settings,
    pub(super) calls: Option<&'a Calls>,
    pub(super) team: &'a Team,
    pub(super) scenes: KnownScenes,
}

impl Workshop<'_> {
    /// Makes those of the items that the folder lacks, and puts its lines in order. Returns the reason if it stopped early.
    pub(super) fn fill(
        &self,
        run: &mut RunFolder,
        data: &WorldData,
        items: &[Item],
        output: &Output,
    ) -> Result<Option<Stop>, Error> {
        let styles = &self.plan.styles;
        let numbers = |measured: &Measured| {
            let style = measured.style.name.clone();
            (0..self.settings.per_path).map(move |number| text_name(&style, number))
        };
        let names: Vec<String> = styles.iter().flat_map(numbers).collect();
        let left = run.left(items, &names);
        if left.len() < items.len() {
            let done = items.len() - left.len();
            let (all, left) = (count(items.len(), "item"), left.len());
            output.say(format_args!("continuing: {done} of {all} done and kept, {left} to do"));
        }
        let mut progress = Progress::new(output, items.len(), left.len(), self.calls, self.team.lookout());
        let kept = self.make(run, data, &left, &mut progress, items.len(), output);
        kept?;
        run.arrange(items.iter(), &names)?;
        run.sync()?;
        Ok(progress.end())
    }

    fn make(
        &self,
        run: &mut RunFolder,
        data: &WorldData,
        left: &[&Item],
        progress: &mut Progress<'_>,
        all: usize,
        output: &Output,
    ) -> Result<(), Error> {
        let (calls, styles) = (self.calls, &self.plan.styles);
        let workers = calls.map_or_else(cores, Calls::workers);
        let expected = if calls.is_some() { self.plan.calls_per_item(left, self.team.lookout())? } else { 0.0 };
        let pace = Pace::new(left.len(), workers, expected);
        let world = RunPlatform { platform: self.plan.platform, data: Some(data), scenes: &self.scenes };
        let unmade = AtomicUsize::new(left.len());
        let making = |item: &Item| {
            interrupt::check()?;
            let threads = calls.map_or(1, |calls| calls.views_at_once(unmade.load(Ordering::Relaxed)));
            let made = make(item, self.settings, world, self.team, styles, threads);
            unmade.fetch_sub(1, Ordering::Relaxed);
            made
        };
        let occasion = Occasion::here();
        let making = |item: &&Item| {
            occasion.on(|| {
                let mut span = ItemSpan::begin(item);
                (span.make(|| making(item)), span)
            })
        };
        let bar = progress.bar();
        thread::scope(|scope| {
            if let Some(calls) = calls {
                let (pace, bar) = (&pace, &bar);
                let said = |told: &str| output.in_lines(format_args!("{}/{all} items, {told}", bar.position()));
                scope.spawn(move || pace.watch(|| calls.spent(), |told| bar.set_message(told.to_owned()), said));
            }
            let kept = in_order(left, workers, making, |item, (made, span)| {
                let fate = keep(run, world, item, made, styles)?;
                span.end(&fate);
                pace.item_is_done();
                progress.takes_note(run, fate)
            });
            pace.end();
            kept
        })
    }
}
