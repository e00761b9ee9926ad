//! A table of values (.csv) by which one graph is evaluated many times.
//!
//! The first row names columns: an input (`node.input`), a parameter of the graph, `seed`, or `name`, which is what the row is
//! called; without one it is called by its number, from 1. An empty cell leaves what the graph has.
//!
//! Guarantees: names of rows are unique, also where letters' case does not count, and may be part of a file's name. Not
//! guaranteed: that values fit, which each row says for itself.

use super::Exit;
use super::eval::EvalArgs;
use super::given::input_of;
use crate::jobs::open::read_packed;
use crate::jobs::stop::Stop;
use coif_graphs::document::Socket;
use coif_graphs::text::whole_number;
use coif_nodes::define::short;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// More rows than anybody looks at; reading them takes no memory to speak of.
const MOST_ROWS: usize = 100_000;
/// The largest table that is read.
const MOST_BYTES: u64 = 64 << 20;

/// What stands for the row's name in `--out`.
const NAME: &str = "{name}";

/// A table that was read.
pub(super) struct Sweep {
    file: PathBuf,
    columns: Vec<String>,
    rows: Vec<Row>,
}

struct Row {
    line: u64,
    name: String,
    cells: Vec<String>,
}

impl Sweep {
    /// Reads a table.
    ///
    /// # Errors
    /// What is wrong with it, with its line.
    pub(super) fn read(file: &Path) -> Result<Self, Stop> {
        let fault = |reason: &str| Stop::refused(format!("{}: {reason}", file.display()));
        match std::fs::metadata(file) {
            Ok(about) if !about.is_file() => return Err(fault("is not a file")),
            Ok(about) if about.len() > MOST_BYTES => return Err(fault("is larger than 64 MiB")),
            Ok(_) => {}
            Err(err) if err.kind() == std::io::ErrorKind::NotFound => {
                return Err(fault("no such file"));
            }
            Err(err) => return Err(fault(&err.to_string())),
        }
        let text = std::fs::read_to_string(file).map_err(|err| fault(&err.to_string()))?;
        Self::parse(file, text.trim_start_matches('\u{feff}')).map_err(|reason| fault(&reason))
    }

    fn parse(file: &Path, text: &str) -> Result<Self, String> {
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let head = reader.headers().map_err(|err| err.to_string())?;
        let columns: Vec<String> = head.iter().map(ToOwned::to_owned).collect();
        let mut known = BTreeMap::new();
        for (number, column) in (1..).zip(&columns) {
            if column.is_empty() {
                return Err(
                    "a column has no name: the first row names an input each, as node.input".into(),
                );
            }
            if let Some(before) = known.insert(column, number) {
                return Err(format!(
                    "columns {before} and {number} are both called {:?}",
                    short(column)
                ));
            }
        }
        let mut records = vec![];
        for record in reader.records() {
            // The csv reader says the line and how many fields there were.
            let record = record.map_err(|err| err.to_string())?;
            let line = record.position().map_or(0, csv::Position::line);
            records.push((line, record.iter().map(ToOwned::to_owned).collect::<Vec<String>>()));
            if records.len() > MOST_ROWS {
                return Err(format!("has more than {MOST_ROWS} rows"));
            }
        }
        if records.is_empty() {
            return Err("has no rows below its first".into());
        }
        let width = records.len().to_string().len();
        let named = columns.iter().position(|column| column == "name");
        let mut names = BTreeMap::<String, (u64, String)>::new();
        let mut rows = vec![];
        for (i, (line, cells)) in records.into_iter().enumerate() {
            let name = match named.map(|at| &cells[at]) {
                Some(name) => name.clone(),
                None => format!("{:0width$}", i + 1),
            };
            if !may_name_a_file(&name) {
                return Err(format!(
                    "line {line}: {:?} is no name: letters, digits and any of - _ . within, 100 at most",
                    short(&name)
                ));
            }
            let before = names.insert(name.to_lowercase(), (line, name.clone()));
            if let Some((first, before)) = before {
                return Err(format!(
                    "line {line}: {name:?} is the name of the row of line {first}, {before:?}, too, for which case does not count"
                ));
            }
            rows.push(Row { line, name, cells });
        }
        Ok(Self { file: file.to_owned(), columns, rows })
    }

    /// Names of its rows.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.rows.iter().map(|row| row.name.as_str())
    }

    /// Its rows: what each is called, and the inputs that it sets.
    pub(super) fn each(&self) -> impl Iterator<Item = (&str, Vec<(&str, &str)>)> {
        self.rows.iter().map(|row| {
            let cells = self.columns.iter().zip(&row.cells).filter(|(column, cell)| {
                !cell.is_empty() && !matches!(column.as_str(), "name" | "seed")
            });
            let cells = cells.map(|(column, cell)| (column.as_str(), cell.as_str()));
            (row.name.as_str(), cells.collect())
        })
    }

    /// Refuses a column that names no input of a graph, or the same input as an earlier column.
    pub(super) fn refuse_unknown_columns(
        &self,
        graph: &Path,
        allow_large: bool,
    ) -> Result<(), Stop> {
        let document = read_packed(graph, allow_large)?.loaded.document;
        let mut known = BTreeMap::new();
        let inputs =
            self.columns.iter().filter(|column| !matches!(column.as_str(), "name" | "seed"));
        for column in inputs {
            let refused = |reason: String| {
                let (file, column) = (self.file.display(), short(column));
                Stop::refused(format!("{file}: column {column:?}: {reason}"))
            };
            let (socket, input) = input_of(&document, column).map_err(refused)?;
            let input = Socket::new(socket.node, input.name);
            if let Some(before) = known.insert(input.clone(), column) {
                let before = short(before);
                return Err(refused(format!("sets {input}, and so does the column {before:?}")));
            }
        }
        Ok(())
    }

    /// The words of a command for each row, and what the row is called.
    ///
    /// # Errors
    /// A column is no input, or rows would be written to one file.
    pub(super) fn all(&self, args: &EvalArgs) -> Result<Vec<(String, EvalArgs)>, Stop> {
        self.refuse_unknown_columns(&args.groom.graph, args.groom.allow_large)?;
        if args.skip_done {
            return Err(Stop::refused("--skip-done: is for one evaluation; name it by --row"));
        }
        let nameless = args.out.iter().find(|out| !out.to_string_lossy().contains(NAME));
        if let Some(out) = nameless.filter(|_| self.rows.len() > 1) {
            return Err(Stop::refused(format!(
                "--out {}: {} rows need a file each: write {NAME} where the row's name is to stand",
                out.display(),
                self.rows.len()
            )));
        }
        self.rows.iter().map(|row| Ok((row.name.clone(), self.with(row, args)?))).collect()
    }

    /// Lets the words of a command be those for one row.
    ///
    /// # Errors
    /// No row has this name, or a column is no input.
    pub(super) fn apply(&self, name: &str, args: &mut EvalArgs) -> Result<(), Stop> {
        self.refuse_unknown_columns(&args.groom.graph, args.groom.allow_large)?;
        let row = self.rows.iter().find(|row| row.name == name).ok_or_else(|| {
            let known: Vec<&str> = self.names().take(20).collect();
            Stop::refused(format!(
                "--row {}: {} has no such row; it has {}",
                short(name),
                self.file.display(),
                known.join(", ")
            ))
        })?;
        *args = self.with(row, args)?;
        args.row = Some(row.name.clone());
        Ok(())
    }

    fn with(&self, row: &Row, args: &EvalArgs) -> Result<EvalArgs, Stop> {
        let mut args = args.clone();
        for (column, cell) in
            self.columns.iter().zip(&row.cells).filter(|(_, cell)| !cell.is_empty())
        {
            match column.as_str() {
                "name" => {}
                "seed" => {
                    let whole = whole_number(cell).and_then(|seed| u64::try_from(seed).ok());
                    let seed = cell.parse().ok().or(whole).ok_or_else(|| {
                        let (file, cell) = (self.file.display(), short(cell));
                        Stop(
                            Exit::Refused,
                            vec![format!(
                                "{file}: line {}: seed is a whole number from 0, not {cell:?}",
                                row.line
                            )],
                        )
                    })?;
                    args.groom.seed = Some(seed);
                }
                input => args.groom.set.push(format!("{input}={cell}")),
            }
        }
        for out in &mut args.out {
            *out = out.to_string_lossy().replace(NAME, &row.name).into();
        }
        Ok(args)
    }
}

/// Whether a file may be called so on every system.
pub(super) fn may_name_a_file(name: &str) -> bool {
    let is_good = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    name.chars().all(is_good)
        && name.starts_with(char::is_alphanumeric)
        && !name.ends_with('.')
        && name.chars().count() <= 100
}
