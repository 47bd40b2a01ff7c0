//! Python's `Map`: the scenes of a platform, and the walks that fit a text.

use crate::{
    call::run_patiently,
    raise::{exception_for, exception_of_kind},
};
use pyo3::prelude::*;
use std::{collections::BTreeMap, path::PathBuf};
use wayword_core::{Heading, Platform, SceneId, ViewpointId};
use wayword_run::{
    follow::KnownScenes,
    platforms::{self, PlatformPlace},
    walk_ranking::MeantWalk,
};

/// The scenes of a platform, each surveyed when it is first asked for.
#[pyclass(frozen, module = "wayword._wayword")]
pub(crate) struct Map {
    platform: Box<dyn Platform>,
    scenes: KnownScenes,
}

#[pymethods]
impl Map {
    #[new]
    #[pyo3(signature = (platform, data=None, at=None, island=None, connectivity=None))]
    fn new(
        py: Python<'_>,
        platform: &str,
        data: Option<PathBuf>,
        at: Option<&str>,
        island: Option<usize>,
        connectivity: Option<PathBuf>,
    ) -> PyResult<Self> {
        let opened = run_patiently(py, || {
            let (data, connectivity) = (data.as_deref(), connectivity.as_deref());
            platforms::open_at(platform, PlatformPlace { data, at, island, connectivity })
        })?;
        Ok(Self { platform: opened.map_err(|error| exception_for(py, error))?, scenes: KnownScenes::new() })
    }

    /// The names of the scenes.
    fn scenes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let scenes =
            run_patiently(py, || Ok(self.platform.list_scenes()?))?.map_err(|error| exception_for(py, error))?;
        Ok(scenes.into_iter().map(|scene| scene.to_string()).collect())
    }

    /// The viewpoints of a scene: positions of the eye, metres.
    fn viewpoints(&self, py: Python<'_>, scene: &str) -> PyResult<BTreeMap<String, (f64, f64, f64)>> {
        let scene = value_from_python(py, SceneId::new(scene))?;
        let graph = run_patiently(py, || Ok(self.platform.graph_for_scene(&scene)?))?
            .map_err(|error| exception_for(py, error))?;
        let place = |id: &ViewpointId| Some((id.to_string(), graph.position_of(id)?.into()));
        Ok(graph.viewpoints().filter_map(place).collect())
    }

    /// The walks that a text may mean, the likeliest first: their viewpoints and how likely each is.
    fn follow(
        &self,
        py: Python<'_>,
        text: &str,
        from: (&str, &str, f64),
        most: usize,
    ) -> PyResult<Vec<(Vec<String>, f64)>> {
        let (scene, start, heading) = from;
        let (scene, start) =
            (value_from_python(py, SceneId::new(scene))?, value_from_python(py, ViewpointId::new(start))?);
        let heading = value_from_python(py, Heading::new(heading))?;
        let found =
            run_patiently(py, || self.scenes.meant_walks(&*self.platform, (&scene, &start, heading), text, most))?;
        let walk = |walk: MeantWalk| (walk.viewpoints.iter().map(ToString::to_string).collect(), walk.share);
        Ok(found.map_err(|error| exception_for(py, error))?.into_iter().map(walk).collect())
    }
}

/// A value from Python, or the exception for an invalid one.
fn value_from_python<T, E: ToString>(py: Python<'_>, made: Result<T, E>) -> PyResult<T> {
    made.map_err(|error| exception_of_kind(py, "input", (error.to_string(), None, None)))
}
