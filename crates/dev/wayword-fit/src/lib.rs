//! Fits the weights that ship with the program to people's texts of training splits, and prints how they do on buildings that were left
//! out.

pub mod fit_evidence;
pub mod fit_follower;
