//! Who takes instructions apart.

use super::plan::Plan;
use crate::{
    calls::Calls,
    cli::Compare,
    commands::config,
    error::Error,
    settings::{Asked, AskedRoles, Job, RULES},
};
use wayword_navigation::directions::{ByModel, ByRules, Splitter};

/// How the splitter's model is reached: it is the only one of the job, in the place of the one who asks.
pub(super) fn job(args: &Compare, plan: &Plan) -> Result<Job, Error> {
    let roles = AskedRoles { ask: Some(plan.split.clone()), base_url: plan.base_url.clone(), ..AskedRoles::default() };
    let asked = Asked { service: args.service.clone(), ..Asked::default() };
    let file = config::read(args.config.as_deref())?;
    let file = Asked { providers: file.providers, service: file.service, ..Asked::default() };
    let mut asked = asked.or(file);
    asked.roles = roles;
    asked.job()
}

/// The splitter of a name.
pub(super) fn splitter(name: &str, calls: Option<&Calls>) -> Result<Box<dyn Splitter>, Error> {
    match calls.filter(|_| name != RULES) {
        Some(calls) => Ok(Box::new(ByModel::new(calls.model(name)?))),
        None => Ok(Box::new(ByRules)),
    }
}
