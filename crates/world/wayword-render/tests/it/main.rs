//! The integration tests of `wayword-render`, one program: a module for each topic.

mod cubemap;
mod drawing;
mod matterport_oracle;
mod same_everywhere;
