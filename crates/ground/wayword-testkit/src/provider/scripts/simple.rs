//! The simplest models.

use crate::provider::{Heard, Script};

/// Says the same each time.
#[derive(Debug, Clone)]
pub struct Fixed(pub String);

/// Says what it was told last.
#[derive(Debug, Clone, Copy, Default)]
pub struct Echo;

/// Says what a function makes of what it hears.
pub struct Told<F>(pub F);

impl Fixed {
    /// A model that says this.
    #[must_use]
    pub fn new(text: &str) -> Self {
        Self(text.to_owned())
    }
}

impl Script for Fixed {
    fn reply(&self, _: &Heard) -> String {
        self.0.clone()
    }
}

impl Script for Echo {
    fn reply(&self, heard: &Heard) -> String {
        heard.prompt().to_owned()
    }
}

impl<F: Fn(&Heard) -> String + Send + Sync> Script for Told<F> {
    fn reply(&self, heard: &Heard) -> String {
        (self.0)(heard)
    }
}
