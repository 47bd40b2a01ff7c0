//! Judges how a scene lies in its file: which direction is up, and how long its unit is. A floor decides: large level ground,
//! connected, with room above for people, on which things stand.

mod columns;
mod direction;
mod floors;
#[cfg(test)]
mod tests;
mod unit;

use crate::{
    axes::{habitat_from_wayword, wayword_from_habitat},
    file_error::FileError,
    scene::{HabitatStage, SceneModel},
};
use columns::FreeColumns;
use direction::{AS_READ, AxisDirection, SixFloors, UpVerdict};
use floors::FloorSurvey;
use glam::{DVec3, Vec3};
use unit::{OTHER_UNITS, SceneUnit};

/// Least width of a scene on which anybody can walk, metres.
const MIN_WIDTH_M: f64 = 2.0;
const CONFIG_HINT: &str = "\"Axes and units\" in docs/DATA.md explains these settings";
const TOLD_HINT: &str = "correct up, front or units_to_meters in its stage_config.json";

/// How a scene is to be read.
#[derive(Debug, PartialEq)]
pub(crate) struct ScenePlacement {
    /// The stage with the axes and the unit in which it is to be read.
    pub(crate) stage: HabitatStage,
    /// What was decided against Habitat's rule, and how to settle it.
    pub(crate) note: Option<String>,
}

/// Judges how a scene lies. `model` must have been read as `stage` says. What the stage's configuration tells is kept.
///
/// # Errors
/// If axes or unit are neither told nor clear, or if what is told cannot be.
pub(crate) fn judge_placement(model: &SceneModel, stage: &HabitatStage) -> Result<ScenePlacement, FileError> {
    let mut triangles: Vec<[Vec3; 3]> =
        model.triangles().filter(|triangle| triangle.iter().all(|corner| corner.is_finite())).collect();
    let mut placement = ScenePlacement { stage: stage.clone(), note: None };
    if triangles.is_empty() {
        return Ok(placement);
    }
    let size = SizeText(&triangles).to_string();
    let unit_m = resolve_unit(&triangles, &size, stage)?;
    triangles.iter_mut().flatten().for_each(|corner| *corner *= unit_m as f32);
    check_width(&triangles, &size, stage)?;
    let floors = survey_floors(&triangles);
    let up = resolve_up(&floors, stage, unit_m)?;
    if up == AS_READ && unit_m == 1.0 {
        return Ok(placement);
    }
    let axes = AssetAxes::new(stage, up, unit_m);
    let mut reasons = Vec::new();
    if unit_m != 1.0 {
        reasons.push(format!("it is {size} units large, and people fit into its rooms at this unit"));
    }
    if up != AS_READ {
        let opposite = AxisDirection { is_negative: !up.is_negative, ..up };
        reasons.push(list_floors(&floors, stage, |direction| [up, opposite, AS_READ].contains(&direction)));
    }
    placement.note = Some(format!(
        "it is read with {axes}, because {}; to settle this, {}",
        reasons.join("; "),
        axes.describe_config(stage)
    ));
    placement.stage.habitat_from_asset = HabitatStage::habitat_from_axes(axes.up, axes.front) * axes.units_to_meters;
    Ok(placement)
}

/// The floors in all six directions.
fn survey_floors(triangles: &[[Vec3; 3]]) -> SixFloors {
    SixFloors([0, 1, 2].map(|axis| {
        let along = FreeColumns::along_axis(triangles, axis);
        [FloorSurvey::from_columns(&along), FloorSurvey::from_columns(&along.upside_down())]
    }))
}

/// The length of the scene's unit, as a factor of the one in which it was read.
fn resolve_unit(triangles: &[[Vec3; 3]], size: &str, stage: &HabitatStage) -> Result<f64, FileError> {
    match unit::judge_unit(triangles) {
        SceneUnit::Other(unit) if stage.is_unit_told => {
            let (name, length_m) = OTHER_UNITS[unit];
            let told = stage.units_to_meters();
            let reason = format!(
                "with units_to_meters = {told} it is {size} m large, and its rooms are none for people; they are with \
                 {}, as if it were in {name}",
                round_unit(told * length_m)
            );
            Err(FileError::new(&stage.asset, reason, TOLD_HINT))
        }
        SceneUnit::Other(unit) => Ok(OTHER_UNITS[unit].1),
        SceneUnit::Doubtful if !stage.is_unit_told => {
            let reason = format!(
                "it is {size} units large; these are no metres, and which unit it is cannot be told: write \
                 units_to_meters (0.01 for centimetres, 0.001 for millimetres, 0.0254 for inches, 0.3048 for feet) \
                 into {}",
                stage.config.display()
            );
            Err(FileError::new(&stage.asset, reason, CONFIG_HINT))
        }
        SceneUnit::AsRead | SceneUnit::Doubtful => Ok(1.0),
    }
}

/// Returns an error for a scene that is too small for anybody to walk in.
fn check_width(triangles: &[[Vec3; 3]], size: &str, stage: &HabitatStage) -> Result<(), FileError> {
    if SizeText(triangles).extent().max_element() >= MIN_WIDTH_M {
        return Ok(());
    }
    let reason = format!(
        "it is {size} m large, too small to walk in: its unit is longer than a metre, or it is a model at a smaller \
         scale; write units_to_meters, the metres of one of its units, into {}",
        stage.config.display()
    );
    Err(FileError::new(&stage.asset, reason, if stage.is_unit_told { TOLD_HINT } else { CONFIG_HINT }))
}

/// The direction that is up, in Wayword's frame as the scene was read.
fn resolve_up(floors: &SixFloors, stage: &HabitatStage, unit_m: f64) -> Result<AxisDirection, FileError> {
    let best = floors.by_worth().first().map_or(AS_READ, |(up, _)| *up);
    let listed = list_floors(floors, stage, |_| true);
    if stage.is_up_told {
        if !floors.cannot_be_as_read() {
            return Ok(AS_READ);
        }
        let axes = AssetAxes::new(stage, best, unit_m);
        let reason = format!("its up cannot be right: {listed}; {axes} would fit");
        return Err(FileError::new(&stage.asset, reason, TOLD_HINT));
    }
    match floors.judge_up() {
        UpVerdict::AsRead => Ok(AS_READ),
        UpVerdict::Other(up) => Ok(up),
        UpVerdict::Doubtful => {
            let config = AssetAxes::new(stage, best, unit_m).describe_config(stage);
            let reason = format!("which direction is up cannot be told: {listed}; {config}, or with another up");
            Err(FileError::new(&stage.asset, reason, CONFIG_HINT))
        }
    }
}

/// The floors in some directions, told in those of the scene's file.
fn list_floors(floors: &SixFloors, stage: &HabitatStage, is_told: impl Fn(AxisDirection) -> bool) -> String {
    let told = |(direction, floor): &(AxisDirection, FloorSurvey)| {
        let up = AxisText(asset_direction(stage, *direction));
        format!("{:.1} m2 and {:.1} m2 of things that stand on it with up = {up}", floor.floor_m2, floor.standing_m2)
    };
    let all: Vec<String> = floors.by_worth().iter().filter(|(direction, _)| is_told(*direction)).map(told).collect();
    format!("its largest connected floor has {}", all.join(", "))
}

/// A direction of Wayword's frame in the frame of the scene's file.
fn asset_direction(stage: &HabitatStage, direction: AxisDirection) -> DVec3 {
    let mut along = DVec3::ZERO;
    along[direction.axis] = if direction.is_negative { -1.0 } else { 1.0 };
    let turned = stage.habitat_from_asset.transpose() * habitat_from_wayword(along);
    // Turns by quarters leave rounding errors.
    turned.normalize_or(wayword_from_habitat(along)).to_array().map(|part| (part * 1e6).round() / 1e6 + 0.0).into()
}

/// The axes and the unit of a scene, as a configuration has them.
struct AssetAxes {
    up: DVec3,
    front: DVec3,
    units_to_meters: f64,
}

impl AssetAxes {
    /// The axes of a stage of which `up` is up. The front is the one that glTF and Habitat use with this axis.
    fn new(stage: &HabitatStage, up: AxisDirection, unit_m: f64) -> Self {
        let units_to_meters = round_unit(stage.units_to_meters() * unit_m);
        if up == AS_READ {
            return Self { up: stage.up(), front: stage.front(), units_to_meters };
        }
        let up = asset_direction(stage, up);
        let front = if up.y.abs() > 0.5 { DVec3::NEG_Z } else { DVec3::Y };
        Self { up, front, units_to_meters }
    }

    /// What to write so that the scene is read like this, whatever its floors look like.
    fn describe_config(&self, stage: &HabitatStage) -> String {
        let file = stage.asset.file_name().unwrap_or_default().to_string_lossy();
        let (up, front) = (AxisText(self.up), AxisText(self.front));
        let verb = if stage.config.is_file() { "write these fields into" } else { "write" };
        format!(
            "{verb} {}: {{\"render_asset\": {file:?}, \"up\": {up}, \"front\": {front}, \"units_to_meters\": {}}}",
            stage.config.display(),
            self.units_to_meters
        )
    }
}

impl std::fmt::Display for AssetAxes {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (up, front) = (AxisText(self.up), AxisText(self.front));
        write!(out, "up = {up}, front = {front} and units_to_meters = {}", self.units_to_meters)
    }
}

/// A unit's length without the rounding errors of products.
fn round_unit(length_m: f64) -> f64 {
    format!("{length_m:.6e}").parse().unwrap_or(length_m)
}

/// A direction as a configuration has it.
struct AxisText(DVec3);

impl std::fmt::Display for AxisText {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(out, "[{x}, {y}, {z}]")
    }
}

/// The extent of triangles along the three axes, for display.
struct SizeText<'a>(&'a [[Vec3; 3]]);

impl SizeText<'_> {
    fn extent(&self) -> DVec3 {
        let corners = || self.0.iter().flatten().copied();
        let low = corners().reduce(Vec3::min).unwrap_or_default();
        (corners().reduce(Vec3::max).unwrap_or_default().as_dvec3()) - low.as_dvec3()
    }
}

impl std::fmt::Display for SizeText<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts =
            self.extent().to_array().map(|side| if side < 10.0 { format!("{side:.2}") } else { format!("{side:.0}") });
        write!(out, "{}", parts.join(" x "))
    }
}
