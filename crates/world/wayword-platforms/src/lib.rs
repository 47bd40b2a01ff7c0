//! Where paths and views come from: the built-in house and Matterport3D.
