//! Conversion of Bezier profiles.

use std::ops::Range;

use glam::DVec2;

use super::document::Item;
use super::file::Segments;
use super::tree::Node;
use crate::scene::checks;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;

/// Segments of the profile under `profile` or `segments` after the checks.
pub(super) fn segments(
    report: &mut Report,
    item: &Item,
    profile: Option<Vec<[f64; 2]>>,
    segments: Option<Segments>,
) -> Option<Vec<Vec<DVec2>>> {
    let one_of = "expected either `profile` or `segments`";
    let (curves, nodes): (Vec<_>, Vec<_>) = match (profile, segments) {
        (Some(profile), None) => (vec![profile], item.node.get("profile").into_iter().collect()),
        (None, Some(Segments(curves))) => {
            let nodes = item.node.get("segments").into_iter().flat_map(|node| node.elements());
            (curves, nodes.collect())
        }
        (Some(_), Some(_)) => {
            let message = format!("{} has both `profile` and `segments`", item.place());
            report.error(item.span_of("segments"), message, one_of, None);
            return None;
        }
        (None, None) => {
            let message = format!("{} has neither `profile` nor `segments`", item.place());
            report.error(item.span(), message, one_of, None);
            return None;
        }
    };
    let curves = curves.into_iter().zip(nodes);
    checks::profile(report, curves.map(|(points, node)| curve(points, node)).collect())
}

fn curve(points: Vec<[f64; 2]>, node: Node) -> checks::Curve {
    let point_spans: Vec<Range<usize>> = node.elements().map(|point| point.span()).collect();
    let points = points.into_iter().map(DVec2::from).collect();
    checks::Curve { points, span: node.span(), point_spans }
}
