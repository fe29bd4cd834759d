//! Circles in a graph of files: its strongly connected components of more than one file (Tarjan 1972).

use std::collections::{BTreeMap, BTreeSet};

/// Files that each file imports from.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// All circles, each with its files in the order of their names.
pub fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let mut search = Search::new(graph);
    for file in graph.keys() {
        if !search.index.contains_key(file.as_str()) {
            search.visit(file);
        }
    }
    search.circles
}

struct Search<'a> {
    graph: &'a Graph,
    index: BTreeMap<&'a str, usize>,
    low: BTreeMap<&'a str, usize>,
    stack: Vec<&'a str>,
    circles: Vec<Vec<String>>,
}

impl<'a> Search<'a> {
    const fn new(graph: &'a Graph) -> Self {
        Self { graph, index: BTreeMap::new(), low: BTreeMap::new(), stack: Vec::new(), circles: Vec::new() }
    }

    /// Visits a file and all that it imports; returns the lowest index that is reached from it.
    fn visit(&mut self, file: &'a str) -> usize {
        let index = self.index.len();
        self.index.insert(file, index);
        self.stack.push(file);
        let mut low = index;
        let graph = self.graph;
        for next in graph.get(file).into_iter().flatten() {
            if !self.index.contains_key(next.as_str()) {
                low = low.min(self.visit(next));
            } else if self.stack.contains(&next.as_str()) {
                low = low.min(self.low.get(next.as_str()).copied().unwrap_or(self.index[next.as_str()]));
            }
        }
        self.low.insert(file, low);
        if low == index {
            let start = self.stack.iter().position(|found| *found == file).expect("the file is on the stack");
            let mut circle: Vec<String> = self.stack.split_off(start).into_iter().map(str::to_owned).collect();
            if circle.len() > 1 {
                circle.sort();
                self.circles.push(circle);
            }
        }
        low
    }
}

#[test]
fn a_circle_over_three_files_is_found_and_a_line_is_none() {
    let graph = |edges: &[(&str, &str)]| {
        let mut graph = Graph::new();
        for (from, to) in edges {
            graph.entry((*from).to_owned()).or_default().insert((*to).to_owned());
        }
        graph
    };
    assert_eq!(circles(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])), Vec::<Vec<String>>::new());
    assert_eq!(circles(&graph(&[("x", "a"), ("a", "b"), ("b", "c"), ("c", "a")])), vec![vec!["a", "b", "c"]]);
}
