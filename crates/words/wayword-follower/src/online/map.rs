//! A walker's own map of a building: the viewpoints where it was and their neighbours, in the frame of its start.

use crate::{
    building::KnownBuilding,
    building_parts::{BuildingThing, BuildingViewpoint},
};
use wayword_core::{DVec3, Heading, ObjectLabel};
use wayword_language::lexicon::normalise_name;

/// The walker's observation at a viewpoint. Directions are relative to its body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WalkerSighting {
    /// The ways out.
    pub hops: Vec<WalkerHop>,
    /// The room, where the platform has rooms.
    pub room: Option<String>,
    /// The objects that are seen.
    pub things: Vec<WalkerThing>,
}

/// An object that a walker sees.
#[derive(Debug, Clone, PartialEq)]
pub struct WalkerThing {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub place: ThingDirection,
}

/// Where a walker sees an object, relative to its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ThingDirection {
    /// At the end of this way, as if it could be walked.
    At(WalkerHop),
    /// Somewhere in the direction of the hop with this number.
    Towards(usize),
}

impl WalkerThing {
    /// The object of a label, for a walker that looks along `heading`; `None` where there is no hop to tell its direction by.
    #[must_use]
    pub fn from_label(label: &ObjectLabel, hops: &[WalkerHop], heading: Heading) -> Option<Self> {
        let place = match label.distance_m {
            Some(length_m) => ThingDirection::At(WalkerHop {
                turn_rad: heading.turn_to(label.heading),
                elevation_rad: label.elevation_rad,
                length_m,
            }),
            None => ThingDirection::Towards(WalkerHop::nearest_hop(hops, heading, label.heading)?),
        };
        Some(Self { name: label.name.clone(), place })
    }
}

/// A way out of a viewpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkerHop {
    /// Its direction from straight ahead, radians, positive right.
    pub turn_rad: f64,
    /// Its elevation, radians, positive upwards.
    pub elevation_rad: f64,
    /// Its length, metres.
    pub length_m: f64,
}

impl WalkerHop {
    /// The way from one place to another (metres, world frame), for a walker that looks along `heading`. Straight up or
    /// down counts as ahead, because the walker's heading stays.
    #[must_use]
    pub fn between(from: DVec3, to: DVec3, heading: Heading) -> Self {
        let off = to - from;
        Self {
            turn_rad: Heading::towards(from, to).map_or(0.0, |bearing| heading.turn_to(bearing)),
            elevation_rad: libm::atan2(off.z, libm::hypot(off.x, off.y)),
            length_m: off.length(),
        }
    }

    /// The number of the hop that lies nearest to a direction; `None` where there is none. `heading` is the walker's.
    #[must_use]
    pub fn nearest_hop(hops: &[Self], heading: Heading, direction: Heading) -> Option<usize> {
        let off_rad = |hop: &Self| heading.turned_by(hop.turn_rad).turn_to(direction).abs();
        (0..hops.len()).min_by(|a, b| off_rad(&hops[*a]).total_cmp(&off_rad(&hops[*b])))
    }
}

/// Two viewpoints closer than this are taken for one, metres. The walker adds up its hops, so its positions for the same place
/// differ a little each time.
const SAME_PLACE_M: f64 = 0.05;
/// Largest assumed distance of an object that is seen in the direction of a hop, metres; over a shorter hop, the hop's length.
const MAX_THING_DISTANCE_M: f64 = 1.5;

/// A map of where a walker was.
#[derive(Debug, Default)]
pub(super) struct WalkerMap {
    pub(super) building: KnownBuilding,
    /// The walker's viewpoint.
    pub(super) here: usize,
    /// The walker's direction, radians clockwise; 0 is its first direction.
    pub(super) heading_rad: f64,
    /// For each viewpoint, where each hop out of it leads, in the order of its sighting.
    pub(super) ways: Vec<Vec<usize>>,
}

impl WalkerMap {
    /// The map of a walker that has not looked yet.
    pub(super) fn new() -> Self {
        let mut map = Self::default();
        map.add_viewpoint(DVec3::ZERO);
        map
    }

    /// Goes over to a viewpoint that is one hop away.
    pub(super) fn go_to(&mut self, to: usize) {
        let (bearing_rad, _) = self.building.hop_between(self.here, to);
        self.heading_rad = bearing_rad.unwrap_or(self.heading_rad);
        self.here = to;
    }

    /// Adds the observation at the walker's viewpoint to the map.
    pub(super) fn note_sighting(&mut self, sighting: &WalkerSighting) {
        let here_m = self.building.viewpoints[self.here].position;
        let offsets: Vec<DVec3> = sighting.hops.iter().map(|hop| self.hop_offset(hop)).collect();
        if self.building.viewpoints[self.here].is_known {
            let ends = self.ways[self.here].iter().map(|to| self.building.viewpoints[*to].position);
            let is_close = |(end, off): (DVec3, &DVec3)| end.distance(here_m + *off) < 2.0 * SAME_PLACE_M;
            if offsets.len() == self.ways[self.here].len() && ends.zip(&offsets).all(is_close) {
                return;
            }
            // This is another viewpoint at the same place: some graphs have two.
            self.here = self.add_viewpoint(here_m);
        }
        let ways: Vec<usize> = offsets.iter().map(|off| self.viewpoint_at(here_m + *off)).collect();
        for to in &ways {
            join_viewpoints(&mut self.building.viewpoints, self.here, *to);
            join_viewpoints(&mut self.building.viewpoints, *to, self.here);
        }
        self.ways[self.here] = ways;
        for thing in &sighting.things {
            let off = match thing.place {
                ThingDirection::At(way) => self.hop_offset(&way),
                ThingDirection::Towards(hop) => {
                    let Some(off) = offsets.get(hop) else { continue };
                    off.normalize_or_zero() * off.length().min(MAX_THING_DISTANCE_M)
                }
            };
            self.building.things.push(BuildingThing {
                name: normalise_name(&thing.name),
                position: here_m + off,
                seen_from: vec![self.here],
            });
        }
        let viewpoint = &mut self.building.viewpoints[self.here];
        viewpoint.room.clone_from(&sighting.room);
        viewpoint.is_known = true;
        // Distances that were computed for the smaller map no longer hold.
        self.building.forget_nearness();
    }

    /// The offset of a hop from the walker's viewpoint.
    fn hop_offset(&self, hop: &WalkerHop) -> DVec3 {
        let rad = self.heading_rad + hop.turn_rad;
        let flat_m = hop.length_m * libm::cos(hop.elevation_rad);
        DVec3::new(flat_m * libm::sin(rad), flat_m * libm::cos(rad), hop.length_m * libm::sin(hop.elevation_rad))
    }

    /// The viewpoint at a position: a known one, or a new one.
    fn viewpoint_at(&mut self, position: DVec3) -> usize {
        let is_here = |viewpoint: &BuildingViewpoint| viewpoint.position.distance(position) < SAME_PLACE_M;
        self.building.viewpoints.iter().position(is_here).unwrap_or_else(|| self.add_viewpoint(position))
    }

    /// Adds a viewpoint where the walker was not yet, and returns its number.
    fn add_viewpoint(&mut self, position: DVec3) -> usize {
        self.building.viewpoints.push(BuildingViewpoint {
            position,
            neighbours: Vec::new(),
            room: None,
            level: None,
            is_known: false,
            climbs: [false; 2],
        });
        self.ways.push(Vec::new());
        self.building.viewpoints.len() - 1
    }
}

/// Makes a viewpoint a neighbour of another, once.
fn join_viewpoints(viewpoints: &mut [BuildingViewpoint], from: usize, to: usize) {
    if from != to && !viewpoints[from].neighbours.contains(&to) {
        viewpoints[from].neighbours.push(to);
    }
}
