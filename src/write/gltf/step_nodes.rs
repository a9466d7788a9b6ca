//! The nodes of each step, and the empty node above them in a file of several steps.
//!
//! Whoever opens the file finds each step in one place, and an animation by frames has one channel for each step: a
//! program that imports it makes one action for a step where it would make one for each object.

use std::collections::BTreeMap;

use gltf::json::{self, Index};
use serde_json::json;

use super::document::Document;
use crate::pipeline::step_label;
use crate::write::WriteError;

/// The nodes of a file in the making that have no parent yet.
#[derive(Default)]
pub(super) struct StepNodes {
    /// The nodes of no single step: the marker, morphing parts.
    of_all: Vec<Index<json::Node>>,
    /// The nodes of each step.
    of_step: BTreeMap<usize, Vec<Index<json::Node>>>,
}

/// The nodes of a finished file.
pub(super) struct Roots {
    /// The nodes without a parent, in the order of the file.
    pub(super) all: Vec<Index<json::Node>>,
    /// The step and node of everything that belongs to one step and has no parent.
    pub(super) of_steps: Vec<(usize, Index<json::Node>)>,
}

impl StepNodes {
    /// Adds a node that belongs to `step`, or to the whole file.
    pub(super) fn add(&mut self, step: Option<usize>, node: Index<json::Node>) {
        match step {
            Some(step) => self.of_step.entry(step).or_default().push(node),
            None => self.of_all.push(node),
        }
    }

    /// The steps that have nodes, in their order.
    pub(super) fn steps(&self) -> impl Iterator<Item = usize> {
        self.of_step.keys().copied()
    }

    /// The roots of the file. Where it holds several steps, the nodes of each become the children of one node,
    /// `step003`, which moves nothing and has the step and its proper time in its `extras`.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn into_roots(
        self,
        document: &mut Document<'_>,
        proper_times: &[f64],
    ) -> Result<Roots, WriteError> {
        let mut of_steps = vec![];
        let has_parents = self.of_step.len() > 1;
        for (step, nodes) in self.of_step {
            if !has_parents {
                of_steps.extend(nodes.into_iter().map(|node| (step, node)));
                continue;
            }
            let parent = document.node(&json!({
                "name": step_label(step),
                "children": nodes,
                "extras": { "step": step, "proper_time": proper_times.get(step) },
            }))?;
            of_steps.push((step, parent));
        }
        let mut all = self.of_all;
        all.extend(of_steps.iter().map(|(_, node)| *node));
        if !has_parents {
            all.sort_by_key(Index::value);
        }
        Ok(Roots { all, of_steps })
    }
}
