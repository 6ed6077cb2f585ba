//! Why a simulator was not built, in words. Things are told by their index, as a description has no names.

use core::fmt::{Display, Formatter, Result};

use super::BuildError;
use crate::climate::ClimateError;
use crate::parameter::{ParameterError, Reason};
use crate::{MethodError, NetworkError, PlanError};

impl Display for ParameterError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let reason = match self.reason {
            Reason::NotFinite => "is not finite",
            Reason::Negative => "is below 0",
            Reason::NotPositive => "is not above 0",
            Reason::NotAFraction => "does not lie in 0 … 1",
            Reason::OutsideValidity => "lies outside the range for which its law is known",
            Reason::NotFalling => "does not make the head curve fall with flow",
        };
        write!(f, "`{}` {reason}", self.parameter)
    }
}

impl Display for NetworkError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Empty => f.write_str("there is no node or no line"),
            Self::Reference(error) => write!(f, "reference pressure: {error}"),
            Self::Node(index, error) => write!(f, "node {index}: {error}"),
            Self::UnconnectedNode(index) => write!(f, "node {index}: no line reaches it"),
            Self::NoSuchNode(index) => write!(f, "line {index}: it names a node that does not exist"),
            Self::SegmentRange(index) => {
                write!(
                    f,
                    "line {index}: it has no segment, or its segments do not follow those of the line before"
                )
            }
            Self::FlowSegment(index) => write!(f, "line {index}: its flow segment lies outside it"),
            Self::Line(index, error) => write!(f, "line {index}: {error}"),
            Self::LineWithoutLoss(index) => {
                write!(f, "line {index}: it loses no pressure at any flow, so its flow has no value")
            }
            Self::Segment(index, error) => write!(f, "segment {index}: {error}"),
            Self::InputRange(index) => write!(f, "segment {index}: its inputs lie outside the network's"),
            Self::InputValue(index) => write!(f, "segment {index}: an input starts out of its range"),
            Self::ActiveList => f.write_str("the list of active segments is not that of the segments"),
            Self::ResponsiveList(index) => {
                write!(f, "line {index}: the list of responsive lines is not that of the segments")
            }
            Self::Schedule(index) => write!(f, "schedule {index}: input, points, times or values do not fit"),
            Self::Plan(error) => write!(f, "connection tables: {error}"),
        }
    }
}

impl Display for PlanError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Missing => f.write_str("they are missing, and the method needs them"),
            Self::Ends(index) => write!(f, "the line ends of node {index} are not those of the lines"),
            Self::Order => f.write_str("the elimination order does not hold each unknown pressure once"),
            Self::Pattern(index) => write!(f, "row {index} is not sorted, or lacks an entry or its fill"),
            Self::Stamp(index) => write!(f, "the stamps of line {index} do not point at its entries"),
            Self::Composite => {
                f.write_str("the list of lines with several flows is not that of the segments")
            }
            Self::Between(index) => write!(f, "the points of segment {index} are not those of its line"),
            Self::Term(index) => write!(f, "the terms of node {index} are not those of lines and order"),
            Self::Series => f.write_str("the rows with two later neighbours are not those of the pattern"),
        }
    }
}

impl Display for MethodError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Step { longest_us } => {
                write!(f, "the step is 0 or longer than the method allows, {longest_us} µs")
            }
            Self::NodeTooSmall(index) => write!(f, "node {index} is too small for this step"),
            Self::Junction(index) => write!(f, "node {index} is a junction, the method needs volumes"),
            Self::Liquid(index) => write!(f, "node {index} is liquid, the method moves gas only"),
            Self::Climate => {
                f.write_str("heat and moisture need physical flows, those of this method are pseudo-time's")
            }
            Self::Plan(error) => write!(f, "connection tables: {error}"),
            Self::TooMuchRemoved(index) => write!(f, "line {index} drains more than 11.8 % of its flow"),
            Self::PressureDifference(index) => {
                write!(f, "line {index} starts over more than 10 kPa, too much for pseudo-time")
            }
            Self::Responsive(index) => {
                write!(
                    f,
                    "line {index} responds to pressure, direction, memory or density, the method takes no such line"
                )
            }
            Self::SeveralBetweenNodes(index) => write!(
                f,
                "line {index} has several elements that need the pressures at both their ends between two known ones"
            ),
            Self::NothingResists(index) => {
                write!(
                    f,
                    "segment {index} has neither inertance nor a loss at rest, so nothing decides its flow"
                )
            }
        }
    }
}

impl Display for ClimateError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Volumes => f.write_str("there is not one volume per node"),
            Self::Volume(index, error) => write!(f, "volume {index}: {error}"),
            Self::Junction(index) => write!(f, "node {index} has no volume for what it holds"),
            Self::Media(index) => write!(f, "line {index} joins air and coolant"),
            Self::GasLaw(index) => write!(f, "line {index} holds coolant and has a law of gases"),
            Self::InnerVolume(index) => write!(f, "segment {index} has a volume inside its line"),
            Self::Removal(index) => write!(f, "segment {index} takes out a fixed share of its flow"),
            Self::Table(index) => write!(f, "table {index} of components does not follow the one before"),
            Self::Component(index, error) => write!(f, "component {index}: {error}"),
            Self::ComponentStep(index, bound) => write!(
                f,
                "component {index}: {} must be at least {} {} for this step",
                bound.parameter, bound.least, bound.unit
            ),
            Self::ComponentNode(index) => {
                write!(f, "component {index} names no volume, or one that it does not fit")
            }
            Self::Conductance(index, most) => write!(
                f,
                "component {index}: all walls of its volume together may conduct at most {most} W/K for this step"
            ),
            Self::Passage(index) => write!(
                f,
                "passage {index} names a component that does not exist, is out of order, or leads through the wrong medium"
            ),
            Self::Sides(index) => {
                write!(f, "component {index} lacks the stream of its own side, or has two on one side")
            }
            Self::Loop(index, error) => write!(f, "control loop {index}: {error}"),
            Self::LoopTarget(index) => write!(
                f,
                "control loop {index} measures or drives what does not exist, or what something else drives"
            ),
            Self::Input(slot) => {
                write!(f, "input {slot} lies outside the network's inputs, or starts out of its range")
            }
        }
    }
}

impl Display for BuildError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Network(error) => error.fmt(f),
            Self::Method(error) => error.fmt(f),
            Self::Climate(error) => error.fmt(f),
            Self::Buffer { name, needed, given } => {
                write!(f, "buffer `{name}` has {given} words, {needed} are needed")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn a_refusal_is_a_sentence_with_place_and_reason() {
        let error = ParameterError { parameter: "volume_m3", reason: Reason::NotPositive };
        let text = BuildError::Network(NetworkError::Node(3, error)).to_string();
        assert_eq!(text, "node 3: `volume_m3` is not above 0");
        let text = BuildError::Buffer { name: "work", needed: 9, given: 4 }.to_string();
        assert_eq!(text, "buffer `work` has 4 words, 9 are needed");
        for (error, wanted) in [
            (BuildError::Network(NetworkError::Plan(PlanError::Pattern(7))), "row 7 "),
            (BuildError::Method(MethodError::Step { longest_us: 10_000 }), "10000 µs"),
            (BuildError::Method(MethodError::Liquid(5)), "node 5 is liquid"),
            (BuildError::Climate(ClimateError::Media(2)), "line 2 joins air and coolant"),
        ] {
            let text = error.to_string();
            assert!(text.contains(wanted), "{text}");
            // No names of this program.
            assert!(!text.contains("Error") && !text.contains('('), "{text}");
        }
    }
}
