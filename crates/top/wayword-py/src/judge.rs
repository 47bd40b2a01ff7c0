//! Python's `TrajectoryJudge` and `SubmissionScores`: reads trajectories from Python objects, scores them, and returns their figures.

use crate::{
    call::run_patiently,
    raise::{exception_for, exception_of_kind},
};
use pyo3::{
    exceptions::{PyLookupError, PyTypeError, PyValueError},
    intern,
    prelude::*,
    types::{PyBytes, PyDict, PyList, PyString, PyTuple},
};
use std::{collections::BTreeSet, ops::Range, path::PathBuf};
use wayword_experiments::{
    episodes,
    judge::{SubmissionScores as Figures, SubmissionScoring, TrajectoryJudge as Episodes, TrajectoryProblems},
};
use wayword_formats::{Episode, submission};
use wayword_metrics::{TrajectoryMetric, TrajectorySuccessRule};
use wayword_run::{
    error::CommandError,
    platforms::{self, PlatformPlace},
};

/// The episodes that trajectories are scored by.
#[pyclass(frozen, module = "wayword._wayword")]
pub(crate) struct Judge {
    prepared: Episodes,
    /// As they were read: a file may name their instructions in a way of its own.
    episodes: Vec<Episode>,
}

#[pymethods]
impl Judge {
    #[new]
    #[pyo3(signature = (episodes, platform, data=None, at=None, island=None, connectivity=None))]
    fn new(
        py: Python<'_>,
        episodes: PathBuf,
        platform: &str,
        data: Option<PathBuf>,
        at: Option<&str>,
        island: Option<usize>,
        connectivity: Option<PathBuf>,
    ) -> PyResult<Self> {
        let judge = run_patiently(py, || -> Result<Self, CommandError> {
            let (data, connectivity) = (data.as_deref(), connectivity.as_deref());
            let platform = platforms::open_at(platform, PlatformPlace { data, at, island, connectivity })?;
            let episodes = episodes::read_episodes(&episodes, platform.as_ref())?;
            Ok(Self { prepared: Episodes::new(&episodes, platform.as_ref())?, episodes })
        })?;
        judge.map_err(|error| exception_for(py, error))
    }

    /// How many instructions there are.
    fn __len__(&self) -> usize {
        self.prepared.instruction_count()
    }

    /// The figures of the trajectories in a file, which may name instructions in any way that `evaluate` reads.
    fn score_file(&self, py: Python<'_>, file: PathBuf, partial: bool) -> PyResult<Scores> {
        let scored = py.detach(|| {
            let mut reading = submission::read_submission(&file);
            // Python has no line for the way, and the names of the scores are those of the episodes.
            let _ = submission::name_as_episodes(&mut reading, &self.episodes);
            self.prepared.score_all(&reading, &BTreeSet::new(), partial)
        });
        scored.map(|(scores, _)| Scores(scores)).map_err(|problems| problems_error(py, &problems))
    }

    /// The figures of trajectories: a list of `{"instr_id", "trajectory", "predObjId"}`, or a mapping from instructions to
    /// trajectories.
    fn score(&self, py: Python<'_>, submission: &Bound<'_, PyAny>, partial: bool) -> PyResult<Scores> {
        let mut scoring = self.prepared.begin_submission();
        let mut handed = TrajectoryPart::default();
        each_trajectory(submission, |name, trajectory, object| {
            handed.take_trajectory(name, trajectory, object)?;
            if handed.trajectories.len() == PART_TRAJECTORIES {
                py.detach(|| handed.score_part(&mut scoring));
            }
            Ok(())
        })?;
        let scored = py.detach(|| {
            handed.score_part(&mut scoring);
            scoring.finish_submission(TrajectoryProblems::default(), partial)
        });
        scored.map(Scores).map_err(|problems| problems_error(py, &problems))
    }
}

/// The exception for a submission that is not scored.
fn problems_error(py: Python<'_>, problems: &TrajectoryProblems) -> PyErr {
    let listed: Vec<(Option<&str>, &str)> =
        problems.listed_problems().iter().map(|problem| (problem.instr_id.as_deref(), &*problem.problem)).collect();
    let exception = py
        .import("wayword.errors")
        .and_then(|errors| errors.getattr("SubmissionError"))
        .and_then(|class| class.call1((listed, problems.count(), problems.missing_count())));
    exception.map_or_else(|error| error, PyErr::from_value)
}

/// The exception for a trajectory that cannot be read.
fn unread_error(py: Python<'_>, at: usize, what: &str) -> PyErr {
    let hint = "give {\"instr_id\": ..., \"trajectory\": [...]}, and \"predObjId\" where an object is named";
    exception_of_kind(py, "submission", (what.to_owned(), Some(format!("trajectory {at}")), Some(hint.to_owned())))
}

/// Hands on the name, the trajectory and the object of each entry.
fn each_trajectory<'py>(
    submission: &Bound<'py, PyAny>,
    mut take: impl FnMut(&Bound<'py, PyAny>, &Bound<'py, PyAny>, Option<&Bound<'py, PyAny>>) -> PyResult<()>,
) -> PyResult<()> {
    let py = submission.py();
    let flawed = |at: usize| {
        move |error: PyErr| {
            let is_wrong_entry = error.is_instance_of::<PyTypeError>(py) || error.is_instance_of::<PyValueError>(py);
            // All other exceptions come from the caller's own iterators and are passed on.
            let is_wrong_entry = is_wrong_entry || error.is_instance_of::<PyLookupError>(py);
            if is_wrong_entry { unread_error(py, at, &error.to_string()) } else { error }
        }
    };
    if let Ok(mapping) = submission.cast::<PyDict>() {
        for (at, (name, trajectory)) in mapping.iter().enumerate() {
            take(&name, &trajectory, None).map_err(flawed(at))?;
        }
        return Ok(());
    }
    for (at, entry) in submission.try_iter()?.enumerate() {
        let entry = entry?;
        let entry = entry.cast::<PyDict>().map_err(|_| unread_error(py, at, "it is no dictionary"))?;
        let needed = |field: &Bound<'py, PyString>| {
            entry.get_item(field)?.ok_or_else(|| unread_error(py, at, &format!("it has no {field}")))
        };
        let (name, trajectory) = (needed(intern!(py, "instr_id"))?, needed(intern!(py, "trajectory"))?);
        let object = entry.get_item(intern!(py, "predObjId"))?.filter(|object| !object.is_none());
        take(&name, &trajectory, object.as_ref()).map_err(flawed(at))?;
    }
    Ok(())
}

/// How many trajectories are copied before they are scored: few, so that the copies stay in the processor's cache.
const PART_TRAJECTORIES: usize = 256;

/// A part of the trajectories from Python, copied, so that the interpreter can be released while they are scored.
#[derive(Default)]
struct TrajectoryPart {
    /// All texts (instructions, viewpoints, objects), one after the other. The ranges of bytes below point into it.
    names: String,
    /// The viewpoints of all trajectories, each as a range of `names`.
    steps: Vec<Range<usize>>,
    trajectories: Vec<HandedTrajectory>,
}

/// One trajectory of a [`TrajectoryPart`].
struct HandedTrajectory {
    /// The instruction, as a range of `names`.
    name: Range<usize>,
    /// Its viewpoints, as a range of `steps`.
    steps: Range<usize>,
    /// The object that the agent names, as a range of `names`.
    object: Option<Range<usize>>,
}

impl TrajectoryPart {
    /// Scores the trajectories, and is empty afterwards.
    fn score_part(&mut self, scoring: &mut SubmissionScoring<'_>) {
        for trajectory in &self.trajectories {
            let names = self.steps[trajectory.steps.clone()].iter().map(|step| self.text_at(step));
            scoring.take_trajectory(
                self.text_at(&trajectory.name),
                names,
                trajectory.object.as_ref().map(|object| self.text_at(object)),
            );
        }
        self.names.clear();
        self.steps.clear();
        self.trajectories.clear();
    }

    /// Copies one trajectory.
    fn take_trajectory(
        &mut self,
        name: &Bound<'_, PyAny>,
        trajectory: &Bound<'_, PyAny>,
        object: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let name = self.keep_text(name)?;
        let first = self.steps.len();
        if let Ok(list) = trajectory.cast::<PyList>() {
            for step in list.iter() {
                self.take_step(&step)?;
            }
        } else if trajectory.is_instance_of::<PyString>() {
            return Err(PyTypeError::new_err("the trajectory is a text, and not a list of viewpoints"));
        } else {
            for step in trajectory.try_iter()? {
                self.take_step(&step?)?;
            }
        }
        // An object's id may be a number, as in the dataset.
        let object =
            object.map(|object| object.str().and_then(|object| self.keep_text(object.as_any()))).transpose()?;
        self.trajectories.push(HandedTrajectory { name, steps: first..self.steps.len(), object });
        Ok(())
    }

    /// Takes a viewpoint, a viewpoint with angles, or several viewpoints, as VLN-DUET gives them.
    fn take_step(&mut self, step: &Bound<'_, PyAny>) -> PyResult<()> {
        let is_more = if let Ok(pose) = step.cast::<PyTuple>() {
            // Borrowed, because a submission has many steps.
            let first = pose.get_borrowed_item(0)?;
            self.take_viewpoint(&first)?;
            pose.len() > 1 && pose.get_borrowed_item(1)?.is_instance_of::<PyString>()
        } else if step.is_instance_of::<PyString>() {
            return self.take_viewpoint(step);
        } else {
            let pose = step.cast::<PyList>()?;
            self.take_viewpoint(&pose.get_item(0)?)?;
            pose.len() > 1 && pose.get_item(1)?.is_instance_of::<PyString>()
        };
        if is_more {
            for viewpoint in step.try_iter()?.skip(1) {
                self.take_viewpoint(&viewpoint?)?;
            }
        }
        Ok(())
    }

    fn take_viewpoint(&mut self, name: &Bound<'_, PyAny>) -> PyResult<()> {
        let name = self.keep_text(name)?;
        self.steps.push(name);
        Ok(())
    }

    /// Copies a text from Python, and returns its place in the copies.
    fn keep_text(&mut self, text: &Bound<'_, PyAny>) -> PyResult<Range<usize>> {
        let first = self.names.len();
        self.names.push_str(text.cast::<PyString>()?.to_str()?);
        Ok(first..self.names.len())
    }

    fn text_at(&self, at: &Range<usize>) -> &str {
        self.names.get(at.clone()).unwrap_or_default()
    }
}

/// Mean, low, high, trajectories, paths.
type FigureInterval = (f64, f64, f64, usize, usize);

/// The figures of trajectories, in the order of the episodes.
#[pyclass(frozen, module = "wayword._wayword")]
pub(crate) struct Scores(Figures);

#[pymethods]
impl Scores {
    /// How many trajectories there are.
    fn __len__(&self) -> usize {
        self.0.rows().len()
    }

    /// The instructions.
    fn names(&self) -> Vec<&str> {
        self.0.instruction_names().collect()
    }

    /// Scene and path of each: figures of one path are not independent.
    fn paths(&self) -> Vec<&str> {
        self.0.path_names().collect()
    }

    /// Whether a rule of success can be applied.
    fn has_rule(&self, py: Python<'_>, rule: &str) -> PyResult<bool> {
        Ok(self.0.has_rule(parse_name(py, rule)?))
    }

    /// A figure of each trajectory, as 64-bit numbers in the machine's order; NaN where there is none.
    fn values<'py>(&self, py: Python<'py>, metric: &str, rule: &str) -> PyResult<Bound<'py, PyBytes>> {
        let (metric, rule) = (parse_name(py, metric)?, parse_name(py, rule)?);
        let values = py.detach(|| {
            let value = |value: Option<f64>| value.unwrap_or(f64::NAN).to_ne_bytes();
            self.0.metric_values(metric, rule).flat_map(value).collect::<Vec<u8>>()
        });
        Ok(PyBytes::new(py, &values))
    }

    /// The mean of a figure; `None` where no trajectory has it.
    fn mean(&self, py: Python<'_>, metric: &str, rule: &str) -> PyResult<Option<f64>> {
        let (metric, rule): (TrajectoryMetric, TrajectorySuccessRule) =
            (parse_name(py, metric)?, parse_name(py, rule)?);
        Ok(py.detach(|| self.0.metric_mean(metric, rule)))
    }

    /// The mean with its 95 % interval.
    fn estimate(
        &self,
        py: Python<'_>,
        metric: &str,
        rule: &str,
        resamples: usize,
        seed: u64,
    ) -> PyResult<Option<FigureInterval>> {
        let (metric, rule): (TrajectoryMetric, TrajectorySuccessRule) =
            (parse_name(py, metric)?, parse_name(py, rule)?);
        let estimate = py.detach(|| self.0.metric_estimate(metric, rule, resamples, seed));
        Ok(estimate.map(|found| (found.mean, found.low, found.high, found.values, found.clusters)))
    }
}

/// A figure or a rule by its name in files.
fn parse_name<T: serde::de::DeserializeOwned>(py: Python<'_>, name: &str) -> PyResult<T> {
    serde_json::from_value(name.into()).map_err(|error| exception_of_kind(py, "input", (error.to_string(), None, None)))
}
