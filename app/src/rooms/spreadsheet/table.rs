//! Curves as a table: rows of tufts, curves or points, columns of what is known of them.
//!
//! Guarantees: a cell is found in time logarithmic in the number of tufts and curves, whatever the number of rows; nothing is
//! copied. A curve that lacks an attribute has an empty cell, not the declared default: the table shows what there is.

use super::filter::{self, Filter};
use coif_nodes::data::attributes::{Column as Values, Domain as Of};
use coif_nodes::data::curves::{AttributeView, Curves, Tuft};
use std::collections::{BTreeMap, BTreeSet};

/// What a row is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Domain {
    /// Curves made from one parent.
    Tuft,
    /// One curve.
    #[default]
    Curve,
    /// One point of a curve.
    Point,
}

/// A column: what it shows, and how it is called in filters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Column {
    /// As filters and headings have it.
    pub(crate) name: String,
    /// What it means, for the tooltip.
    pub(crate) doc: &'static str,
    /// Whether it is shown before anybody chose.
    pub(crate) at_first: bool,
    /// Whether its cells are ids: long, and not to be summed up.
    pub(crate) ids: bool,
    what: What,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum What {
    Node,
    Tuft,
    Curve,
    Point,
    Curves,
    Points,
    Length,
    Place(usize),
    /// Name and component.
    Attribute(String, usize),
}

/// What a cell holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Nothing.
    Empty,
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// A name made of a hash.
    Id(u64),
    /// Words.
    Text(String),
}

impl Cell {
    /// As a number; NaN where there is none.
    pub(crate) fn number(&self) -> f64 {
        match self {
            Cell::Whole(x) => *x as f64,
            Cell::Number(x) => *x,
            Cell::Id(id) => *id as f64,
            Cell::Empty | Cell::Text(_) => f64::NAN,
        }
    }
    /// As people and files read it.
    pub(crate) fn text(&self) -> String {
        match self {
            Cell::Empty => String::new(),
            Cell::Whole(x) => x.to_string(),
            Cell::Number(x) => crate::words::shortest(*x, 6),
            Cell::Id(0) => "none".to_owned(),
            Cell::Id(id) => format!("{id:016x}"),
            Cell::Text(text) => text.clone(),
        }
    }
}

/// Where a row lies: numbers of its tuft, of its curve within the tuft, of its point within the tuft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct At {
    tuft: usize,
    curve: usize,
    point: usize,
}

/// A table over curves.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    curves: Curves,
    domain: Domain,
    /// Rows before each tuft, and all.
    starts: Vec<usize>,
    /// Curves before each tuft.
    curves_before: Vec<usize>,
    /// The node that tufts come from: the number of the first that does not, and its name.
    parts: Vec<(usize, String)>,
    columns: Vec<Column>,
}

/// Lowest, highest and mean number of a column, and how many cells are no number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Statistics {
    /// Lowest.
    pub(crate) min: f64,
    /// Highest.
    pub(crate) max: f64,
    /// Mean.
    pub(crate) mean: f64,
    /// Cells that hold NaN or nothing.
    pub(crate) nans: usize,
}

impl Table {
    /// The table of curves. `parts` names the nodes they come from, in order, each with the number of its tufts.
    pub(crate) fn new(curves: Curves, domain: Domain, parts: &[(usize, String)]) -> Self {
        let (mut starts, mut curves_before) = (vec![0], vec![0]);
        for (i, tuft) in curves.tufts().iter().enumerate() {
            let rows = match domain {
                Domain::Tuft => 1,
                Domain::Curve => tuft.len(),
                Domain::Point => tuft.points().len(),
            };
            starts.push(starts[i] + rows);
            curves_before.push(curves_before[i] + tuft.len());
        }
        let mut end = 0;
        let ends = parts.iter().map(|(tufts, name)| {
            end += tufts;
            (end, name.clone())
        });
        let parts: Vec<_> = ends.collect();
        let columns = columns(&curves, domain, parts.len() > 1);
        Self { curves, domain, starts, curves_before, parts, columns }
    }

    /// The curves that it shows.
    pub(crate) fn curves(&self) -> &Curves {
        &self.curves
    }
    /// What its rows are.
    pub(crate) fn domain(&self) -> Domain {
        self.domain
    }
    /// All columns.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }
    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// Where a row lies; none past the end.
    pub(crate) fn locate(&self, row: usize) -> Option<At> {
        if row >= self.rows() {
            return None;
        }
        let tuft = self.starts.partition_point(|start| *start <= row) - 1;
        let within = row - self.starts[tuft];
        let offsets = self.curves.tufts()[tuft].offsets();
        Some(match self.domain {
            Domain::Tuft => At { tuft, curve: 0, point: 0 },
            Domain::Curve => At { tuft, curve: within, point: offsets[within] as usize },
            Domain::Point => {
                let curve = offsets.partition_point(|offset| *offset as usize <= within) - 1;
                At { tuft, curve, point: within }
            }
        })
    }

    /// The ids of the curves that a row is about.
    pub(crate) fn ids(&self, row: usize) -> Vec<u64> {
        let Some(at) = self.locate(row) else { return vec![] };
        let tuft = &self.curves.tufts()[at.tuft];
        match self.domain {
            Domain::Tuft => (0..tuft.len()).map(|i| tuft.id(i)).collect(),
            Domain::Curve | Domain::Point => vec![tuft.id(at.curve)],
        }
    }

    /// Whether a row is about any of these curves.
    pub(crate) fn is_about(&self, row: usize, curves: &BTreeSet<u64>) -> bool {
        let Some(at) = self.locate(row).filter(|_| !curves.is_empty()) else { return false };
        let tuft = &self.curves.tufts()[at.tuft];
        match self.domain {
            Domain::Tuft => (0..tuft.len()).any(|i| curves.contains(&tuft.id(i))),
            Domain::Curve | Domain::Point => curves.contains(&tuft.id(at.curve)),
        }
    }

    /// What a row holds in a column.
    pub(crate) fn cell(&self, row: usize, column: &Column) -> Cell {
        let Some(at) = self.locate(row) else { return Cell::Empty };
        let tuft = &self.curves.tufts()[at.tuft];
        self.bound(column, at.tuft, tuft).at(self, at, tuft)
    }

    /// The column of a name.
    pub(crate) fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Calls `f` with every row and its cell in a column, in order, until it says stop.
    fn each(&self, column: &Column, mut f: impl FnMut(usize, Cell) -> bool) {
        let mut row = 0;
        for (i, tuft) in self.curves.tufts().iter().enumerate() {
            let bound = self.bound(column, i, tuft);
            let mut one = |at: At| {
                let go = f(row, bound.at(self, at, tuft));
                row += 1;
                go
            };
            let go = match self.domain {
                Domain::Tuft => one(At { tuft: i, curve: 0, point: 0 }),
                Domain::Curve => (0..tuft.len())
                    .all(|c| one(At { tuft: i, curve: c, point: tuft.offsets()[c] as usize })),
                Domain::Point => (0..tuft.len())
                    .all(|c| tuft.range(c).all(|p| one(At { tuft: i, curve: c, point: p }))),
            };
            if !go {
                return;
            }
        }
    }

    /// All numbers of a column; none when `stop` says so.
    pub(crate) fn numbers(&self, column: &Column, stop: &dyn Fn() -> bool) -> Option<Vec<f64>> {
        let mut all = Vec::with_capacity(self.rows());
        self.each(column, |row, cell| {
            all.push(cell.number());
            !(row % 65_536 == 0 && stop())
        });
        (all.len() == self.rows()).then_some(all)
    }

    /// The rows that pass a filter, in order; none when `stop` says so. The error names a column that there is not.
    pub(crate) fn filtered(
        &self,
        filter: &Filter,
        stop: &dyn Fn() -> bool,
    ) -> Result<Option<Vec<u32>>, String> {
        let columns: Vec<&Column> = filter
            .names()
            .iter()
            .map(|name| self.column(name).ok_or_else(|| format!("there is no column {name:?}")))
            .collect::<Result<_, _>>()?;
        let mut rows = vec![];
        let mut row = 0;
        for (i, tuft) in self.curves.tufts().iter().enumerate() {
            let bound: Vec<Bound> = columns.iter().map(|c| self.bound(c, i, tuft)).collect();
            for _ in self.starts[i]..self.starts[i + 1] {
                if row % 65_536 == 0 && stop() {
                    return Ok(None);
                }
                if let Some(at) = self.locate(row) {
                    let cell = |c: usize| match bound[c].at(self, at, tuft) {
                        Cell::Text(text) => filter::FilterValue::Text(text),
                        other => filter::FilterValue::Number(other.number()),
                    };
                    if filter.passes(&cell) {
                        rows.push(row as u32);
                    }
                }
                row += 1;
            }
        }
        Ok(Some(rows))
    }

    /// The rows about any of these curves, in order.
    pub(crate) fn of_curves(&self, ids: &BTreeSet<u64>) -> Vec<u32> {
        let mut rows = vec![];
        for (i, tuft) in self.curves.tufts().iter().enumerate() {
            let start = self.starts[i];
            let picked = (0..tuft.len()).filter(|c| ids.contains(&tuft.id(*c)));
            match self.domain {
                Domain::Tuft => rows.extend(picked.take(1).map(|_| start as u32)),
                Domain::Curve => rows.extend(picked.map(|c| (start + c) as u32)),
                Domain::Point => {
                    rows.extend(picked.flat_map(|c| tuft.range(c)).map(|p| (start + p) as u32));
                }
            }
        }
        rows
    }

    fn bound<'a>(&'a self, column: &'a Column, at: usize, tuft: &'a Tuft) -> Bound<'a> {
        match &column.what {
            What::Node => {
                let part = self.parts.iter().find(|(end, _)| at < *end);
                part.map_or(Bound::Empty, |(_, name)| Bound::Name(name))
            }
            What::Attribute(name, part) => {
                let part = *part;
                match tuft.attribute(name).map(|attribute| &attribute.values) {
                    Some(Values::F32(_)) => tuft.view_named(name).map(Bound::F32),
                    Some(Values::I32(_)) => tuft.view_named(name).map(Bound::I32),
                    Some(Values::U64(_)) => tuft.view_named(name).map(Bound::U64),
                    Some(Values::Vec2(_)) => tuft.view_named(name).map(|v| Bound::Vec2(v, part)),
                    Some(Values::Vec3(_)) => tuft.view_named(name).map(|v| Bound::Vec3(v, part)),
                    None => None,
                }
                .unwrap_or(Bound::Empty)
            }
            what => Bound::Own(what),
        }
    }
}

/// A column on one tuft.
enum Bound<'a> {
    Empty,
    Name(&'a str),
    Own(&'a What),
    F32(AttributeView<'a, f32>),
    I32(AttributeView<'a, i32>),
    U64(AttributeView<'a, u64>),
    Vec2(AttributeView<'a, glam::Vec2>, usize),
    Vec3(AttributeView<'a, glam::Vec3>, usize),
}

impl Bound<'_> {
    fn at(&self, table: &Table, at: At, tuft: &Tuft) -> Cell {
        let whole = |n: usize| Cell::Whole(n as i64);
        match self {
            Bound::Empty => Cell::Empty,
            Bound::Name(name) => Cell::Text((*name).to_owned()),
            Bound::F32(view) => Cell::Number(f64::from(view.at(at.curve, at.point))),
            Bound::I32(view) => Cell::Whole(i64::from(view.at(at.curve, at.point))),
            Bound::U64(view) => Cell::Id(view.at(at.curve, at.point)),
            Bound::Vec2(view, part) => Cell::Number(f64::from(view.at(at.curve, at.point)[*part])),
            Bound::Vec3(view, part) => Cell::Number(f64::from(view.at(at.curve, at.point)[*part])),
            Bound::Own(what) => match what {
                What::Tuft => whole(at.tuft),
                What::Curve => whole(table.curves_before[at.tuft] + at.curve),
                What::Point => whole(at.point - tuft.offsets()[at.curve] as usize),
                What::Curves => whole(tuft.len()),
                What::Points if table.domain == Domain::Tuft => whole(tuft.points().len()),
                What::Points => whole(tuft.range(at.curve).len()),
                What::Length => {
                    let curve = tuft.curve(at.curve);
                    Cell::Number(curve.windows(2).map(|w| f64::from(w[0].distance(w[1]))).sum())
                }
                What::Place(axis) => Cell::Number(f64::from(tuft.points()[at.point][*axis])),
                What::Node | What::Attribute(..) => Cell::Empty,
            },
        }
    }
}

fn columns(curves: &Curves, domain: Domain, named: bool) -> Vec<Column> {
    let own = |name: &str, doc: &'static str, what: What| Column {
        name: name.to_owned(),
        doc,
        at_first: true,
        ids: false,
        what,
    };
    let mut all = vec![];
    match domain {
        Domain::Tuft => {
            all.push(own("tuft", "Number of the tuft.", What::Tuft));
            all.push(own("curves", "Curves in the tuft.", What::Curves));
            all.push(own("points", "Points in the tuft.", What::Points));
        }
        Domain::Curve => {
            all.push(own("curve", "Number of the curve.", What::Curve));
            all.push(own("points", "Points of the curve.", What::Points));
            all.push(own("length", "Arc length, cm.", What::Length));
            all.push(Column { at_first: false, ..own("tuft", "Number of its tuft.", What::Tuft) });
        }
        Domain::Point => {
            all.push(own("curve", "Number of its curve.", What::Curve));
            all.push(own("point", "Number of the point, from the root.", What::Point));
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                all.push(own(name, "Place, cm.", What::Place(axis)));
            }
            for (name, doc, what) in [
                ("points", "Points of its curve.", What::Points),
                ("length", "Arc length of its curve, cm.", What::Length),
                ("tuft", "Number of its tuft.", What::Tuft),
            ] {
                all.push(Column { at_first: false, ..own(name, doc, what) });
            }
        }
    }
    if named {
        all.push(own("node", "The node that it comes from.", What::Node));
    }
    // Name: components, and whether any tuft has a value for each row's own item.
    let mut found: BTreeMap<&str, (usize, bool)> = BTreeMap::new();
    let mut ids = BTreeSet::new();
    for attribute in curves.tufts().iter().flat_map(|tuft| tuft.attributes()) {
        let parts = match attribute.values {
            Values::Vec2(_) => 2,
            Values::Vec3(_) => 3,
            _ => 1,
        };
        if matches!(attribute.values, Values::U64(_)) {
            ids.insert(attribute.name.as_ref());
        }
        let varies = attribute.values.len() > 1;
        let own = match (domain, attribute.domain) {
            (Domain::Tuft, _) => !varies,
            (Domain::Curve, of) => of == Of::Curve || !varies,
            (Domain::Point, of) => of == Of::Point && varies,
        };
        let entry = found.entry(attribute.name.as_ref()).or_insert((parts, false));
        entry.1 |= own;
    }
    let documented = |name: &str| {
        let declared = coif_nodes::data::attributes::DECLARED;
        let found = declared.iter().find(|(known, ..)| *known == name);
        found.map_or("An attribute of a node's own.", |(_, _, doc)| doc.trim())
    };
    for (name, (parts, own)) in found {
        // On a tuft or a curve, what varies within has no one value.
        if !own && domain != Domain::Point {
            continue;
        }
        for part in 0..parts {
            let ending = if parts == 1 { "" } else { [".x", ".y", ".z"][part] };
            all.push(Column {
                name: format!("{name}{ending}"),
                doc: documented(name),
                at_first: own && name != "root_bary" && name != "root_triangle",
                ids: ids.contains(name),
                what: What::Attribute(name.to_owned(), part),
            });
        }
    }
    // A column of our own goes before an attribute of the same name.
    let mut seen = BTreeSet::new();
    all.retain(|column| seen.insert(column.name.clone()));
    all
}

/// What can be said of the numbers of some rows; none without numbers.
pub(crate) fn statistics(numbers: impl Iterator<Item = f64>) -> Option<Statistics> {
    let (mut min, mut max, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
    let (mut count, mut nans) = (0usize, 0);
    for x in numbers {
        if x.is_nan() {
            nans += 1;
            continue;
        }
        (min, max, sum, count) = (min.min(x), max.max(x), sum + x, count + 1);
    }
    (count > 0).then(|| Statistics { min, max, mean: sum / count as f64, nans })
}

/// The rows in the order of their numbers; NaN last, equal ones as before.
pub(crate) fn sorted(mut rows: Vec<u32>, numbers: &[f64], descending: bool) -> Vec<u32> {
    let number = |row: &u32| numbers.get(*row as usize).copied().unwrap_or(f64::NAN);
    rows.sort_by(|a, b| {
        let (a, b) = (number(a), number(b));
        match (a.is_nan(), b.is_nan()) {
            (true, true) => std::cmp::Ordering::Equal,
            (true, false) => std::cmp::Ordering::Greater,
            (false, true) => std::cmp::Ordering::Less,
            _ if descending => b.total_cmp(&a),
            _ => a.total_cmp(&b),
        }
    });
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use coif_nodes::data::attributes::{ID, RADIUS};
    use coif_nodes::data::curves::TuftBuilder;
    use glam::Vec3;
    use std::sync::Arc;

    /// Tufts of curves with 2, 3, 4, ... points; curve i of all is i + 1 cm long.
    fn hair(tufts: usize, each: usize) -> Curves {
        let mut all = vec![];
        let mut n = 0;
        for t in 0..tufts {
            let mut tuft = TuftBuilder::new();
            let first = n;
            for _ in 0..each {
                let points = 2 + n % 5;
                let along = |i: usize| Vec3::Y * ((n + 1) as f32 * i as f32 / (points - 1) as f32);
                tuft.push_curve(&(0..points).map(along).collect::<Vec<_>>());
                n += 1;
            }
            tuft.set(ID, Of::Curve, (first as u64 + 1..=n as u64).collect());
            if t % 2 == 0 {
                tuft.set(RADIUS, Of::Curve, vec![0.5 + t as f32]);
            }
            all.push(Arc::new(tuft.build()));
        }
        Curves::new(all)
    }

    #[test]
    fn every_row_is_where_the_curves_say() {
        let curves = hair(7, 5);
        let table = Table::new(curves.clone(), Domain::Point, &[]);
        assert_eq!(table.rows(), curves.point_count());
        let mut row = 0;
        for (c, (tuft, i)) in curves.each().enumerate() {
            for (p, place) in tuft.curve(i).iter().enumerate() {
                let cell = |name: &str| table.cell(row, table.column(name).unwrap());
                assert_eq!(cell("curve"), Cell::Whole(c as i64));
                assert_eq!(cell("point"), Cell::Whole(p as i64));
                assert_eq!(cell("y"), Cell::Number(f64::from(place.y)));
                assert_eq!(cell("points"), Cell::Whole(tuft.curve(i).len() as i64));
                row += 1;
            }
        }
        assert_eq!(table.locate(row), None);
        let curve_table = Table::new(curves.clone(), Domain::Curve, &[]);
        let length = curve_table.column("length").unwrap();
        for (c, (tuft, i)) in curves.each().enumerate() {
            assert!((curve_table.cell(c, length).number() - (c + 1) as f64).abs() < 1e-4);
            assert_eq!(curve_table.ids(c), [tuft.id(i)]);
        }
        let all = curve_table.numbers(length, &|| false).unwrap();
        let one_by_one = (0..all.len()).map(|row| curve_table.cell(row, length).number());
        assert!(one_by_one.eq(all.iter().copied()));
    }

    #[test]
    fn missing_values_are_empty_and_counted() {
        let table = Table::new(hair(4, 3), Domain::Curve, &[]);
        let radius = table.column("radius").unwrap();
        assert_eq!(table.cell(0, radius), Cell::Number(0.5));
        assert_eq!(table.cell(3, radius), Cell::Empty);
        let found = statistics(table.numbers(radius, &|| false).unwrap().into_iter()).unwrap();
        assert_eq!((found.min, found.max, found.mean, found.nans), (0.5, 2.5, 1.5, 6));
        assert_eq!(statistics([f64::NAN].into_iter()), None);
    }

    #[test]
    fn filters_and_orders_give_the_rows_they_name() {
        let parts = [(2, "front".to_owned()), (2, "back".to_owned())];
        let table = Table::new(hair(4, 3), Domain::Curve, &parts);
        let filtered = |text: &str| {
            table.filtered(&Filter::read(text).unwrap(), &|| false).map(Option::unwrap)
        };
        assert_eq!(filtered("length < 3.5").unwrap(), [0, 1, 2]);
        assert_eq!(filtered("length < 8.5 and node == \"back\"").unwrap(), [6, 7]);
        assert_eq!(filtered("radius > 1").unwrap(), [6, 7, 8]);
        assert_eq!(filtered("points == 2 or id == 3").unwrap(), [0, 2, 5, 10]);
        assert_eq!(filtered("wet > 1").unwrap_err(), "there is no column \"wet\"");
        let numbers = table.numbers(table.column("radius").unwrap(), &|| false).unwrap();
        let up = sorted((0..12).collect(), &numbers, false);
        assert_eq!(up, [0, 1, 2, 6, 7, 8, 3, 4, 5, 9, 10, 11]);
        let down = sorted((0..12).collect(), &numbers, true);
        assert_eq!(down[..6], [6, 7, 8, 0, 1, 2]);
        assert_eq!(table.of_curves(&[2, 11].into()), [1, 10]);
        let points = Table::new(hair(4, 3), Domain::Point, &parts);
        assert_eq!(points.of_curves(&[2].into()), [2, 3, 4]);
        let tufts = Table::new(hair(4, 3), Domain::Tuft, &parts);
        assert_eq!((tufts.rows(), tufts.of_curves(&[2, 3, 11].into())), (4, vec![0, 3]));
    }

    #[test]
    fn work_stops_when_told() {
        let table = Table::new(hair(4, 3), Domain::Curve, &[]);
        assert_eq!(table.numbers(&table.columns[0], &|| true), None);
        assert_eq!(table.filtered(&Filter::read("1").unwrap(), &|| true), Ok(None));
    }

    #[test]
    fn nothing_has_no_rows() {
        for domain in [Domain::Tuft, Domain::Curve, Domain::Point] {
            let table = Table::new(Curves::default(), domain, &[]);
            assert_eq!((table.rows(), table.locate(0), table.ids(3)), (0, None, vec![]));
        }
    }
}
