//! The turns of a walk, from the yaws between its pictures.

use crate::Side;

/// What counts as a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmTurnRules {
    /// A turn has at least this angle.
    pub least_angle_rad: f64,
    /// Turning back by more than this ends a turn; less is a shake.
    pub most_back_rad: f64,
    /// A turn ends where the camera has turned on by less than [`Self::quiet_rad`] over this many pairs.
    pub quiet_pairs: usize,
    /// What is no turning on, over all of [`Self::quiet_pairs`].
    pub quiet_rad: f64,
    /// Most undecided pairs on end within a turn. They count as no yaw, so the turn is at least as large as said.
    pub most_undecided: usize,
}

impl FilmTurnRules {
    /// The rules for a film with so many pictures for each second: a second without turning ends a turn.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 2 and 60")]
    pub fn at_rate(pictures_per_s: f64) -> Self {
        Self {
            least_angle_rad: 30_f64.to_radians(),
            most_back_rad: 6_f64.to_radians(),
            quiet_pairs: libm::round(pictures_per_s).clamp(2.0, 60.0) as usize,
            quiet_rad: 4_f64.to_radians(),
            most_undecided: 1,
        }
    }
}

/// A turn of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmTurn {
    /// The picture from which it turns.
    pub from_frame: usize,
    /// The picture at which it has turned.
    pub to_frame: usize,
    /// Where to.
    pub side: Side,
    /// By how much; positive.
    pub angle_rad: f64,
}

/// The turns in a row of yaws, in order.
#[must_use]
pub fn find_film_turns(yaws_rad: &[Option<f64>], rules: FilmTurnRules) -> Vec<FilmTurn> {
    let mut turns: Vec<FilmTurn> = [Side::Left, Side::Right]
        .into_iter()
        .flat_map(|side| {
            let sign = if side == Side::Right { 1.0 } else { -1.0 };
            let towards: Vec<Option<f64>> = yaws_rad.iter().map(|yaw| yaw.map(|yaw| sign * yaw)).collect();
            rises(&towards, rules).into_iter().map(move |(from_frame, to_frame, angle_rad)| FilmTurn {
                from_frame,
                to_frame,
                side,
                angle_rad,
            })
        })
        .collect();
    turns.sort_by_key(|turn| turn.from_frame);
    turns
}

/// Where the sum of the yaws rises far enough: first picture, last picture and angle.
fn rises(towards_rad: &[Option<f64>], rules: FilmTurnRules) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::new();
    let mut rise = HeadingRise::from(0);
    for (at, yaw) in towards_rad.iter().enumerate() {
        rise.add(at, *yaw);
        if rise.is_over(rules, towards_rad) {
            found.extend(rise.turn(rules, towards_rad));
            // What came after the top may be the beginning of the next turn.
            rise = HeadingRise::from(at + 1);
        }
        if rise.sum_rad <= 0.0 {
            found.extend(rise.turn(rules, towards_rad));
            rise = HeadingRise::from(at + 1);
        }
    }
    found.extend(rise.turn(rules, towards_rad));
    found
}

/// A rise of the heading while it is followed.
struct HeadingRise {
    from_frame: usize,
    top_frame: usize,
    now_frame: usize,
    sum_rad: f64,
    top_rad: f64,
    undecided: usize,
}

impl HeadingRise {
    fn from(frame: usize) -> Self {
        Self { from_frame: frame, top_frame: frame, now_frame: frame, sum_rad: 0.0, top_rad: 0.0, undecided: 0 }
    }

    fn add(&mut self, at: usize, yaw_rad: Option<f64>) {
        self.now_frame = at + 1;
        self.undecided = if yaw_rad.is_some() { 0 } else { self.undecided + 1 };
        self.sum_rad += yaw_rad.unwrap_or(0.0);
        if self.sum_rad > self.top_rad {
            (self.top_frame, self.top_rad) = (at + 1, self.sum_rad);
        }
    }

    /// Whether it has turned back, gone quiet, or been lost.
    fn is_over(&self, rules: FilmTurnRules, towards_rad: &[Option<f64>]) -> bool {
        let recent =
            towards_rad.get(self.now_frame.saturating_sub(rules.quiet_pairs).max(self.from_frame)..self.now_frame);
        let recent_rad: f64 = recent.unwrap_or(&[]).iter().flatten().sum();
        let is_quiet = self.now_frame - self.from_frame >= rules.quiet_pairs && recent_rad < rules.quiet_rad;
        is_quiet || self.sum_rad < self.top_rad - rules.most_back_rad || self.undecided > rules.most_undecided
    }

    /// The turn up to the top, without the slow ends; none if it is too small.
    fn turn(&self, rules: FilmTurnRules, towards_rad: &[Option<f64>]) -> Option<(usize, usize, f64)> {
        let yaws = towards_rad.get(self.from_frame..self.top_frame)?;
        let sum_rad: f64 = yaws.iter().flatten().sum();
        let slow_rad = (0.05 * sum_rad).max(0.5_f64.to_radians());
        let skipped = |part: &mut dyn Iterator<Item = &Option<f64>>| {
            let mut passed_rad = 0.0;
            part.take_while(|yaw| {
                passed_rad += yaw.unwrap_or(0.0);
                passed_rad <= slow_rad
            })
            .count()
        };
        let (first, last) = (skipped(&mut yaws.iter()), skipped(&mut yaws.iter().rev()));
        let is_turn = sum_rad >= rules.least_angle_rad;
        is_turn.then(|| (self.from_frame + first, self.top_frame - last, sum_rad))
    }
}
