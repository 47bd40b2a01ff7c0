//! The platform on top of a live build.

use super::{
    controller::{ControllerOptions, TdwController},
    error::TdwError,
    scenes::{self, TdwScenePlan},
    session,
};
use crate::live::{
    LivePictureOptions, LivePlatform, ProgressListener, Simulator, SimulatorShot, SimulatorShotKind, SimulatorSurvey,
};
use std::path::PathBuf;
use wayword_core::{DVec3, FailureKind, SceneId};
use wayword_render::PinholeCamera;
use wayword_world::output_lines;

/// Options of the platform.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TdwOptions {
    /// Where to wait for the build.
    pub controller: ControllerOptions,
    /// Folder of the Python package `tdw`. Furnished floor plans need its lists of furniture.
    pub package: Option<PathBuf>,
    /// Size of pictures, and distance between frames.
    pub pictures: LivePictureOptions,
}

/// ThreeDWorld over a live build: scenes `floorplan_1a` to `floorplan_5c` (with furniture `floorplan_1a_0`), and
/// procedural rooms like `room_8x10`.
pub type TdwPlatform = LivePlatform<TdwSimulator>;

/// A build, and the scene that it has loaded.
#[derive(Debug)]
pub struct TdwSimulator {
    controller: TdwController,
    package: Option<PathBuf>,
    size: (u32, u32),
    loaded: Option<SceneId>,
    /// The data that the camera was last set to send, if known.
    camera_data: Option<SimulatorShotKind>,
    progress_listener: ProgressListener,
}

impl TdwPlatform {
    /// A platform that listens at once, and waits for a build at the first request that needs one.
    ///
    /// # Errors
    /// When the port cannot be opened.
    pub fn new(options: TdwOptions) -> Result<Self, TdwError> {
        let TdwOptions { controller, package, pictures } = options;
        let controller = TdwController::bind(controller)?;
        let size = (pictures.width_px, pictures.height_px);
        Ok(Self::from_simulator(
            TdwSimulator {
                controller,
                package,
                size,
                loaded: None,
                camera_data: None,
                progress_listener: ProgressListener::without_listener(),
            },
            pictures,
        ))
    }

    /// Where builds connect to: `tcp://`, the host, and the port that was really opened.
    #[must_use]
    pub fn waits_at(&self) -> String {
        self.address()
    }
}

impl TdwSimulator {
    /// Waits for a build and reports that to the user, also which version has connected.
    fn connect_build(&mut self) -> Result<(), TdwError> {
        let (address, seconds) = (self.controller.address(), self.controller.connect_timeout().as_secs());
        self.progress_listener.report_line(&format!(
            "waiting up to {seconds} s for a ThreeDWorld build to connect to {address}; \
             if it does not run yet, start it with TDW.x86_64 -port {}",
            address.port()
        ));
        let build = self.controller.connect()?.tdw.clone();
        self.progress_listener
            .report_line(&format!("ThreeDWorld build {} has connected", output_lines::to_safe_text(&build, 40)));
        Ok(())
    }
}

/// A hint for a scene without labels. In a floor plan, walls, doors and windows are not objects, so an unfurnished plan
/// has none.
fn unfurnished_hint(scene: Option<&SceneId>) -> String {
    let scene = scene.map_or("the scene", SceneId::as_str);
    let plan =
        scene.get(.."floorplan_1a".len()).filter(|plan| plan.starts_with("floorplan_")).unwrap_or("floorplan_1a");
    format!(
        "{scene} has no furniture, so nothing in it has a label: name a model with --see, or choose a furnished floor \
         plan. Its name ends in a number, as in {plan}_0, and it needs the folder of the Python package tdw as --data"
    )
}

impl Simulator for TdwSimulator {
    type Error = TdwError;
    const NAME: &'static str = "tdw";

    fn address(&self) -> String {
        format!("tcp://{}", self.controller.address())
    }

    fn set_listener(&mut self, ear: ProgressListener) {
        self.progress_listener = ear;
    }

    fn scene_names(&self) -> Vec<String> {
        scenes::scene_names(self.package.as_deref())
    }

    fn scene_name_hint(&self, scene: &SceneId) -> Option<&'static str> {
        let hint = "scenes are named like floorplan_1a, floorplan_1a_0 (furnished) or room_8x10";
        TdwScenePlan::for_scene(scene).is_none().then_some(hint)
    }

    fn enter_scene(&mut self, scene: &SceneId) -> Result<(), TdwError> {
        if !self.controller.is_connected() {
            self.loaded = None;
            self.connect_build()?;
        }
        if self.loaded.as_ref() == Some(scene) {
            return Ok(());
        }
        (self.loaded, self.camera_data) = (None, None);
        let plan =
            TdwScenePlan::for_scene(scene).ok_or_else(|| TdwError::Scene(format!("there is no scene {scene}")))?;
        let commands = plan.load_commands(self.package.as_deref())?;
        self.progress_listener.report_line(&format!(
            "the build loads {scene}; it downloads what it does not have yet, which takes minutes"
        ));
        session::load_scene(&mut self.controller, commands, self.size)?;
        self.loaded = Some(scene.clone());
        Ok(())
    }

    fn survey_scene(&mut self) -> Result<SimulatorSurvey, TdwError> {
        let survey = session::survey_scene(&mut self.controller)?;
        if survey.palette.is_empty() {
            self.progress_listener.report_line(&unfurnished_hint(self.loaded.as_ref()));
        }
        Ok(survey)
    }

    fn take_picture(&mut self, camera: &PinholeCamera, wanted: SimulatorShotKind) -> Result<SimulatorShot, TdwError> {
        let is_camera_set = self.camera_data == Some(wanted);
        self.camera_data = None;
        let shot = session::take_picture(&mut self.controller, camera, (wanted, is_camera_set))?;
        self.camera_data = Some(wanted);
        Ok(shot)
    }

    fn shortest_way(&mut self, _: &SimulatorSurvey, from: DVec3, to: DVec3) -> Result<Option<Vec<DVec3>>, TdwError> {
        session::navmesh_way(&mut self.controller, from, to)
    }

    fn error_hint(error: &TdwError) -> &'static str {
        match error {
            TdwError::Scene(_) => "choose another scene",
            TdwError::Package(_) => {
                "give --data the folder of the Python package tdw, which lists it, or choose another scene"
            }
            TdwError::Bind { .. } => "free the port, or name another with --at, as in --at 127.0.0.1:1072",
            TdwError::NoBuild { .. } => "the build is a separate program that connects to Wayword",
            TdwError::Output(_) => "use a build of version 1.11 to 1.13",
            TdwError::Missing { .. } => "this scene may have no such data: choose another scene",
            TdwError::Quit => "look for the error in its Player.log, and restart it",
            _ => "restart the build, or look into its Player.log",
        }
    }

    fn is_loss(error: &TdwError) -> bool {
        error.is_loss()
    }

    fn failure_kind(error: &TdwError) -> FailureKind {
        match error {
            error if error.is_loss() => FailureKind::Lost,
            TdwError::NoBuild { .. } => FailureKind::Lost,
            TdwError::Bind { .. } | TdwError::Scene(_) | TdwError::Package(_) => FailureKind::Missing,
            _ => FailureKind::Broken,
        }
    }
}
