//! Why a network is not run, in the words of its file.

use eclss_core::climate::ClimateError;
use eclss_core::{BuildError, MethodError, Settings};
use eclss_network_file::bound_of_step;

use crate::{Duration, Failure, Source};

/// Explains a simulator's refusal with ids instead of indices.
pub(crate) fn refused(source: &Source, settings: Settings, error: &BuildError) -> Failure {
    let method = settings.method.name();
    let step = Duration::from_us(u64::from(settings.step_us));
    let node = |index: &u32| source.loaded.names.nodes.get(*index as usize).map_or("?", String::as_str);
    let line = |index: &u32| source.loaded.names.lines.get(*index as usize).map_or("?", String::as_str);
    let reason = match error {
        BuildError::Method(MethodError::Step { longest_us }) => {
            let longest = Duration::from_us(u64::from(*longest_us));
            format!("a step of {step} is too long for method `{method}`; it takes up to {longest}")
        }
        BuildError::Method(MethodError::NodeTooSmall(index)) => format!(
            "node `{}` is too small for method `{method}` at a step of {step}, whose flow it would make \
             diverge; take a shorter step or another method",
            node(index)
        ),
        BuildError::Method(MethodError::Junction(index)) => {
            format!("node `{}` has no volume, which method `{method}` needs", node(index))
        }
        BuildError::Method(MethodError::NothingResists(index)) => {
            let segments = &source.loaded.names.segments;
            let element = segments.get(*index as usize).map_or("?", String::as_str);
            format!("nothing decides the flow of element `{element}`: no inertance, and no loss at rest")
        }
        BuildError::Method(MethodError::PressureDifference(index)) => format!(
            "line `{}` starts over a larger pressure difference than method `{method}` takes; take another method",
            line(index)
        ),
        BuildError::Method(MethodError::Liquid(index)) => {
            format!(
                "node `{}` is liquid, method `{method}` moves gas only; take an implicit method",
                node(index)
            )
        }
        BuildError::Method(MethodError::TooMuchRemoved(index)) => {
            format!(
                "line `{}` drains more than 11.8 % of its flow, too much for method `{method}`",
                line(index)
            )
        }
        BuildError::Method(MethodError::Responsive(index)) => format!(
            "line `{}` has laws that respond to pressures, direction, memory or density, which method `{method}` does \
             not take; take `adaptive` or an implicit method",
            line(index)
        ),
        BuildError::Method(MethodError::SeveralBetweenNodes(index)) => format!(
            "line `{}` has several elements that need the pressures at both their ends, method `{method}` takes one",
            line(index)
        ),
        BuildError::Climate(error) => {
            let loaded = &source.loaded;
            let id = match error {
                ClimateError::ComponentStep(index, _) | ClimateError::Conductance(index, _) => {
                    loaded.names.components.get(*index as usize).map(|id| format!("`{id}`: "))
                }
                _ => None,
            };
            match (id, bound_of_step(error, settings.step_us)) {
                (Some(id), Some(bound)) => id + &bound,
                _ => format!("method `{method}` refuses it: {error}"),
            }
        }
        other => format!("method `{method}` refuses it: {other}"),
    };
    Failure::BadInput(format!("{}: {reason}", source.name))
}
