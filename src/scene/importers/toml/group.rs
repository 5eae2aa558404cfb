//! Groups of shapes and their instances.

use std::collections::{BTreeSet, VecDeque};

use glam::DAffine3;

use super::document::{Document, Item};
use super::file::{GroupFile, InstanceFile};
use super::shape;
use super::transform::placement;
use super::tree::Node;
use crate::scene::Shape;
use crate::scene::builder::{GroupParts, SceneBuilder};
use crate::scene::parts::Part;

/// Nodes of the shapes (`key` is `shapes`) or instances of all groups.
pub(super) fn nodes<'d>(
    document: &'d Document<'d>,
    key: &'static str,
) -> impl Iterator<Item = Node<'d>> {
    let groups = document.items("groups").filter_map(move |item| item.node.get(key));
    groups.flat_map(|list| list.elements())
}

/// Reads all groups, those that others contain first. Reports groups that contain themselves, and
/// warns about groups that are not placed.
pub(super) fn groups(builder: &mut SceneBuilder, document: &Document) -> Vec<GroupParts> {
    let items: Vec<&Item> = document.items("groups").collect();
    let mut files: Vec<Option<GroupFile>> =
        items.iter().map(|item| item.read(&mut builder.report)).collect();
    let index = |instance: &InstanceFile| document.index("groups", &instance.group);
    // groups that contain each one, and how many it waits for
    let mut outer = vec![Vec::new(); items.len()];
    let mut waiting = vec![0usize; items.len()];
    let mut used = BTreeSet::new();
    for (at, file) in files.iter().enumerate() {
        for inner in file.iter().flat_map(|file| &file.instances).filter_map(index) {
            outer[inner].push(at);
            waiting[at] += 1;
            used.insert(inner);
        }
    }
    let mut ready: VecDeque<usize> = (0..items.len()).filter(|at| waiting[*at] == 0).collect();
    let mut made: Vec<GroupParts> = items.iter().map(|_| GroupParts::default()).collect();
    let mut left = items.len();
    while let Some(at) = ready.pop_front() {
        left -= 1;
        if let Some(file) = files[at].take() {
            made[at] = group(builder, document, items[at], file, &made);
        }
        for &next in &outer[at] {
            waiting[next] -= 1;
            if waiting[next] == 0 {
                ready.push_back(next);
            }
        }
    }
    if left > 0 {
        let inner = |at: usize| {
            let instances = files[at].iter().flat_map(|file| &file.instances);
            instances.filter_map(index).find(|inner| waiting[*inner] > 0)
        };
        cycle(builder, &items, &waiting, inner);
    }
    let placed = document.items("instances").filter_map(|item| item.node.get("group")?.str());
    used.extend(placed.filter_map(|name| document.index("groups", name)));
    for (at, item) in items.iter().enumerate().filter(|(at, _)| !used.contains(at)) {
        let message = format!("group `{}` is not used", items[at].name);
        builder.report.warn(item.span(), message, "defined here");
    }
    made
}

/// Reports a group that contains itself: one of those that still wait for `inner` ones.
fn cycle(
    builder: &mut SceneBuilder,
    items: &[&Item],
    waiting: &[usize],
    inner: impl Fn(usize) -> Option<usize>,
) {
    // every waiting group leads to a cycle, which it enters after at most as many steps
    let Some(first) = waiting.iter().position(|count| *count > 0) else { return };
    let Some(at) = (0..items.len()).try_fold(first, |at, _| inner(at)) else { return };
    let by = inner(at).filter(|next| *next != at);
    let by = by.map_or(String::new(), |next| format!(" by way of `{}`", items[next].name));
    let message = format!("group `{}` contains itself{by}", items[at].name);
    let label = "expected instances of groups that do not lead back to it";
    builder.report.error(items[at].span_of("instances"), message, label, None);
}

/// Reads one group; `made` holds those that it contains.
fn group(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: GroupFile,
    made: &[GroupParts],
) -> GroupParts {
    let parts = |key: &'static str| {
        let nodes = item.node.get(key).into_iter().flat_map(|list| list.elements());
        nodes.enumerate().map(move |(k, node)| Item {
            path: format!("{}.{key}[{k}]", item.path),
            name: "",
            node,
            json: None,
        })
    };
    if file.shapes.is_empty() && file.instances.is_empty() {
        let message = format!("group `{}` is empty", item.name);
        builder.report.warn(item.span(), message, "expected shapes or instances");
    }
    let mut all = Vec::new();
    for (part, file) in parts("shapes").zip(file.shapes) {
        all.extend(shape::shapes(builder, document, &part, file).unwrap_or_default());
    }
    for (part, file) in parts("instances").zip(file.instances) {
        all.extend(instance(builder, document, &part, &file, made).unwrap_or_default());
    }
    builder.group(all)
}

/// The shapes of an instance; `None` after an error, which is reported.
pub(super) fn instance(
    builder: &mut SceneBuilder,
    document: &Document,
    item: &Item,
    file: &InstanceFile,
    made: &[GroupParts],
) -> Option<Vec<Shape>> {
    let place = placement(&mut builder.report, item, file.transform.as_ref())?;
    let group = made.get(document.index("groups", &file.group)?)?;
    let map: &DAffine3 = &place.map;
    builder.instance(item, group, map)
}
