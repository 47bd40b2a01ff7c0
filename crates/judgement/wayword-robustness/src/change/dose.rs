//! Changes with a dose: their names, units and ranges. The unit is part of the name, as in `camera_height_m`.

/// The quantity that a dose changes. Its name contains the unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DoseKind {
    /// Height of the eye over the floor, metres.
    CameraHeight,
    /// Horizontal field of view, degrees.
    FieldOfView,
    /// How far the camera looks up, degrees; negative is down.
    Pitch,
    /// How far the camera is turned clockwise around the direction in which it looks, degrees.
    Roll,
    /// Exposure, stops: each doubles the light.
    Exposure,
    /// Colour temperature of the light, kelvin, for a camera that is set to 6500 K.
    ColourTemperature,
    /// Standard deviation of a gaussian blur, pixels.
    Blur,
    /// Standard deviation of a gaussian noise, per cent of full scale.
    Noise,
    /// Quality of the JPEG file that a picture went through, per cent.
    JpegQuality,
    /// Share of the frames between the first and the last that are lost, per cent.
    DroppedFrames,
    /// Distance between two frames along the path, metres.
    FrameSpacing,
    /// Standard deviation of the error of the headings in the log, degrees.
    HeadingNoise,
    /// Turn of the heading at the start, degrees, positive right.
    StartHeading,
}

/// The constant properties of a dose.
struct DoseProperties {
    name: &'static str,
    unit: &'static str,
    /// The value that changes nothing.
    unchanged: Option<f64>,
    range: (f64, f64),
    example: &'static str,
}

impl DoseKind {
    /// All kinds of doses, in the order in which they are explained.
    pub const ALL: [Self; 13] = [
        Self::CameraHeight,
        Self::FieldOfView,
        Self::Pitch,
        Self::Roll,
        Self::Exposure,
        Self::ColourTemperature,
        Self::Blur,
        Self::Noise,
        Self::JpegQuality,
        Self::DroppedFrames,
        Self::FrameSpacing,
        Self::HeadingNoise,
        Self::StartHeading,
    ];

    /// Looks the properties up in the table of all doses.
    fn dose_properties(self) -> DoseProperties {
        let row = |name, unit, unchanged, range, example| DoseProperties { name, unit, unchanged, range, example };
        match self {
            Self::CameraHeight => row("camera_height_m", "m", Some(1.5), (0.1, 2.4), "0.3,0.88,1.6"),
            Self::FieldOfView => row("field_of_view_deg", "degrees", Some(90.0), (20.0, 140.0), "60,90,120"),
            Self::Pitch => row("pitch_deg", "degrees", Some(0.0), (-30.0, 30.0), "-20,-10,10"),
            Self::Roll => row("roll_deg", "degrees", Some(0.0), (-45.0, 45.0), "5,15"),
            Self::Exposure => row("exposure_stops", "stops", Some(0.0), (-6.0, 6.0), "-2,-1,1"),
            Self::ColourTemperature => {
                row("colour_temperature_k", "K", Some(6500.0), (2000.0, 20_000.0), "2700,4000,9000")
            }
            Self::Blur => row("blur_px", "px", Some(0.0), (0.0, 40.0), "1,2,4"),
            Self::Noise => row("noise_percent", "%", Some(0.0), (0.0, 50.0), "2,5,10"),
            Self::JpegQuality => row("jpeg_quality_percent", "%", Some(100.0), (1.0, 100.0), "80,40,10"),
            Self::DroppedFrames => row("dropped_frames_percent", "%", Some(0.0), (0.0, 100.0), "10,30,50"),
            Self::FrameSpacing => row("frame_spacing_m", "m", None, (0.1, 10.0), "0.5,1,3"),
            Self::HeadingNoise => row("heading_noise_deg", "degrees", Some(0.0), (0.0, 180.0), "5,15,45"),
            Self::StartHeading => row("start_heading_deg", "degrees", Some(0.0), (-180.0, 180.0), "45,90,180"),
        }
    }

    /// Its name, with the unit: "`camera_height_m`".
    #[must_use]
    pub fn name(self) -> &'static str {
        self.dose_properties().name
    }

    /// Its unit, as it is written behind a number: "m", "degrees", "%".
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.dose_properties().unit
    }

    /// The value that changes nothing; `None` for the distance between frames, because each path has its own.
    #[must_use]
    pub fn unchanged_value(self) -> Option<f64> {
        self.dose_properties().unchanged
    }

    /// The least and the greatest value.
    #[must_use]
    pub fn value_range(self) -> (f64, f64) {
        self.dose_properties().range
    }

    /// Example values as a user writes them: "0.3,0.88,1.6".
    #[must_use]
    pub fn example_values(self) -> &'static str {
        self.dose_properties().example
    }

    /// Whether it takes only whole numbers.
    #[must_use]
    pub fn is_whole(self) -> bool {
        self == Self::JpegQuality
    }

    /// Describes the effect of a value in one sentence.
    #[must_use]
    pub fn describe_value(self, value: f64) -> String {
        match self {
            Self::CameraHeight => format!("The eye is {value} m above the floor."),
            Self::FieldOfView => format!("Each view is {value} degrees wide."),
            Self::Pitch if value < 0.0 => format!("The camera looks {} degrees down.", -value),
            Self::Pitch => format!("The camera looks {value} degrees up."),
            Self::Roll if value < 0.0 => format!("The camera is rolled {} degrees counter-clockwise.", -value),
            Self::Roll => format!("The camera is rolled {value} degrees clockwise."),
            Self::Exposure => format!("Pictures are exposed {value:+} stops."),
            Self::ColourTemperature => format!("The light has {value} K, for a camera that is set to 6500 K."),
            Self::Blur => format!("Pictures are blurred by a gaussian of {value} px."),
            Self::Noise => format!("Pictures have gaussian noise of {value} % of full scale."),
            Self::JpegQuality => format!("Pictures went through JPEG files of quality {value} %."),
            Self::DroppedFrames => format!("{value} % of the frames between the first and the last are lost."),
            Self::FrameSpacing => format!("The frames of a path are at most {value} m apart."),
            Self::HeadingNoise => {
                format!("The headings in the log are off by a gaussian error of {value} degrees.")
            }
            Self::StartHeading => format!("The walk begins {value} degrees to the right of its heading."),
        }
    }
}
