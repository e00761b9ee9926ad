//! How a command that evaluates is carried out: it is asked to stop, writes its files and its report together, and ends with its code.
//!
//! Guarantees: nothing is in place that was not asked for, nor lies beside it; on failure the report alone is written and says why.

use super::ending::Ending;
use super::{Exit, complain, tell};
use crate::files::{Role, Together};
use crate::jobs::report::Report;
use crate::jobs::stop::{Stop, not_strict};
use crate::words::{first_of, plain_json};
use coif_graphs::schedule::run::CancelToken;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Runs a command that evaluates: whoever asks the process to end asks `body` to stop. What `body` writes and the report are put
/// in place together; where anything fails, the report alone is written and says why. `makes` says what is made, in a word.
/// `summary` is for a person, where no report was asked for. `strict` makes warnings errors.
pub(crate) fn carry_out(
    graph: &Path,
    report_to: Option<&Path>,
    makes: &str,
    strict: bool,
    body: impl FnOnce(&CancelToken, &mut Report, &mut Together) -> Result<(), Stop>,
    summary: impl FnOnce(&Report) -> String,
) -> Exit {
    let began = Instant::now();
    let cancel = CancelToken::default();
    let mut report = Report::new(graph.display().to_string());
    let mut files = Together::default();
    let mut ending = Ending::default();
    ending.on_request_to_end(
        {
            let cancel = cancel.clone();
            move || cancel.cancel()
        },
        at_once(graph, report_to, makes, &files, &cancel),
    );
    let made =
        begin(graph, report_to, &mut files).and_then(|()| body(&cancel, &mut report, &mut files));
    let made = close(made, &mut report, graph, strict, "", began);
    let ended = made.and_then(|()| {
        if let Some(path) = report_to {
            report.files = files.written();
            write_report(path, &report.text(), &mut files, &cancel)?;
        }
        if cancel.is_cancelled() {
            return Err(Stop::interrupted());
        }
        ending.begin();
        files.place(&cancel).map_err(|(path, reason)| Stop::unwritten(&path, &reason, &cancel))
    });
    let Err(stop) = ended else {
        if report_to.is_none() {
            tell(summary(&report));
        }
        return Exit::Done;
    };
    ending.begin();
    let exit = fail(stop, &mut report, &mut files, makes, "");
    if let Some(path) = report_to {
        write_last_report(path, &report.text(), &report.errors, &mut files, &cancel);
    }
    exit
}

/// The same for many evaluations, one after the other, which `all` gives with a name each: each is a step of its own, and one that
/// fails stops no other. The report is the list of theirs. Ends with 1 where any failed, and with the code of `all` where that did.
pub(crate) fn carry_out_each<T>(
    graph: &Path,
    report_to: Option<&Path>,
    makes: &str,
    strict: bool,
    all: impl FnOnce(&mut Together) -> Result<Vec<(String, T)>, Stop>,
    mut body: impl FnMut(&T, &CancelToken, &mut Report, &mut Together) -> Result<(), Stop>,
    summary: impl Fn(&T, &Report) -> String,
) -> Exit {
    let cancel = CancelToken::default();
    let mut files = Together::default();
    let mut ending = Ending::default();
    let texts = Arc::new(Mutex::new(vec![]));
    let add = |report: &Report| {
        texts.lock().unwrap_or_else(PoisonError::into_inner).push(report.text());
    };
    ending.on_request_to_end(
        {
            let cancel = cancel.clone();
            move || cancel.cancel()
        },
        {
            let last = at_once(graph, None, makes, &files, &cancel);
            let (roles, cancel, texts) = (Arc::new(files.another()), cancel.clone(), texts.clone());
            let (graph, report_to) = (graph.display().to_string(), report_to.map(Path::to_owned));
            move || {
                last();
                let mut files = roles.another();
                let may_be = |path: &&PathBuf| files.may_be_by_now(path, Role::Report);
                if let Some(path) = report_to.as_ref().filter(may_be) {
                    let mut report = Report::new(graph.clone());
                    report.errors = vec!["interrupted".to_owned()];
                    report.exit = Exit::Interrupted as u8;
                    let mut all = texts.lock().unwrap_or_else(PoisonError::into_inner).clone();
                    all.push(report.text());
                    let _ = write_report_alone(path, &list_of(&all), &mut files, &cancel);
                }
            }
        },
    );
    let rows = begin(graph, report_to, &mut files).and_then(|()| all(&mut files));
    let mut exit = Exit::Done;
    let rows = rows.unwrap_or_else(|stop| {
        let mut report = Report::new(graph.display().to_string());
        exit = fail(stop, &mut report, &mut files, makes, "");
        add(&report);
        vec![]
    });
    for (name, row) in &rows {
        let (began, mut report) = (Instant::now(), Report::new(graph.display().to_string()));
        let (mut files, said) = (files.another(), format!("{name}: "));
        report.row = Some(name.clone());
        let made = body(row, &cancel, &mut report, &mut files);
        let made = close(made, &mut report, graph, strict, &said, began).and_then(|()| {
            report.files = files.written();
            let placed = files.place(&cancel);
            placed.map_err(|(path, reason)| Stop::unwritten(&path, &reason, &cancel))
        });
        match made {
            Ok(()) if report_to.is_none() => tell(said + &summary(row, &report)),
            Ok(()) => {}
            Err(stop) => {
                report.files.clear();
                let failed = fail(stop, &mut report, &mut files, makes, &said);
                exit = exit.max(if failed == Exit::Interrupted { failed } else { Exit::Failed });
            }
        }
        add(&report);
        if exit == Exit::Interrupted {
            break;
        }
    }
    ending.begin();
    if let Some(path) = report_to {
        let text = list_of(&texts.lock().unwrap_or_else(PoisonError::into_inner));
        let written = write_last_report(path, &text, &[], &mut files, &cancel);
        exit = exit.max(if written { Exit::Done } else { Exit::Failed });
    }
    exit
}

/// Says what an evaluation warned of, each line after `said`, and notes how long it took. `strict` makes warnings errors.
fn close(
    made: Result<(), Stop>,
    report: &mut Report,
    graph: &Path,
    strict: bool,
    said: &str,
    began: Instant,
) -> Result<(), Stop> {
    report.warnings = first_of(std::mem::take(&mut report.warnings));
    report.notes = first_of(std::mem::take(&mut report.notes));
    for warning in &report.warnings {
        complain(format_args!("{said}warning: {warning}"));
    }
    for note in &report.notes {
        complain(format_args!("{said}note: {note}"));
    }
    // Whatever wrote its files after the last look.
    let made = made.and_then(|()| match strict && !report.warnings.is_empty() {
        true => Err(Stop(Exit::Failed, vec![not_strict(graph)])),
        false => Ok(()),
    });
    for output in &report.outputs {
        output.hash.wait();
    }
    report.end(began);
    made
}

/// Forgets what was written and says why, each line after `said`.
fn fail(
    Stop(exit, mut errors): Stop,
    report: &mut Report,
    files: &mut Together,
    makes: &str,
    said: &str,
) -> Exit {
    files.drop_written();
    if let Some(last) = errors.last_mut().filter(|_| exit != Exit::Refused && files.has_outputs()) {
        *last += &format!("; no {makes} was written");
    }
    report.errors = first_of(errors);
    report.errors.iter().for_each(|error| complain(format_args!("{said}{error}")));
    report.exit = exit as u8;
    exit
}

/// Writes all files of a command that makes no report, or none: what `write` writes is put in place together. What is wrong is told,
/// and so is `nothing` where somebody asks it to end.
pub(super) fn in_one_step<T>(
    nothing: &'static str,
    write: impl FnOnce(&mut Together, &CancelToken) -> Result<T, Vec<Stop>>,
) -> Result<T, Exit> {
    let (cancel, mut files) = (CancelToken::default(), Together::default());
    let mut ending = Ending::default();
    ending.on_request_to_end(
        {
            let cancel = cancel.clone();
            move || cancel.cancel()
        },
        move || complain(format_args!("interrupted; {nothing}")),
    );
    let ended = write(&mut files, &cancel).and_then(|written| {
        if cancel.is_cancelled() {
            return Err(vec![Stop::interrupted()]);
        }
        ending.begin();
        let placed = files.place(&cancel);
        placed.map_err(|(path, why)| vec![Stop::unwritten(&path, &why, &cancel)])?;
        Ok(written)
    });
    ended.map_err(|stops| {
        ending.begin();
        files.drop_written();
        stops.iter().flat_map(Stop::lines).for_each(complain);
        stops.into_iter().map(|stop| stop.0).max().unwrap_or(Exit::Refused)
    })
}

/// Writes the report where nothing else is to be written any more, unless its place is refused; says what is wrong with it, but for
/// what was `told` already. Gives whether it is there.
fn write_last_report(
    path: &Path,
    text: &str,
    told: &[String],
    files: &mut Together,
    cancel: &CancelToken,
) -> bool {
    if !files.may_be(path, Role::Report) {
        return false;
    }
    let written = write_report_alone(path, text, files, cancel);
    let lines = written.as_ref().err().into_iter().flat_map(Stop::lines);
    let known = |line: &String| told.iter().any(|error| error.starts_with(&**line));
    lines.filter(|line| !known(line)).for_each(complain);
    written.is_ok()
}

/// Reports as one list.
fn list_of(reports: &[String]) -> String {
    format!("[\n{}\n]", reports.join(",\n"))
}

/// What is left to say and to write where a command is ended before it has come to its end.
fn at_once(
    graph: &Path,
    report_to: Option<&Path>,
    makes: &str,
    files: &Together,
    cancel: &CancelToken,
) -> impl Fn() + Clone + Send + 'static {
    let began = Instant::now();
    let (roles, cancel) = (Arc::new(files.another()), cancel.clone());
    let (graph, report_to) = (graph.display().to_string(), report_to.map(Path::to_owned));
    let said = format!("interrupted; no {makes} was written");
    move || {
        complain(&said);
        let mut files = roles.another();
        let may_be = |path: &&PathBuf| files.may_be_by_now(path, Role::Report);
        if let Some(path) = report_to.as_ref().filter(may_be) {
            let mut report = Report::new(graph.clone());
            report.errors = vec![said.clone()];
            report.exit = Exit::Interrupted as u8;
            report.end(began);
            // Nobody waits to be told what is wrong with the report.
            let _ = write_report_alone(path, &report.text(), &mut files, &cancel);
        }
    }
}

/// Tells `files` what every command reads and writes.
fn begin(graph: &Path, report_to: Option<&Path>, files: &mut Together) -> Result<(), Stop> {
    files
        .reads(graph, format!("the graph {}", graph.display()))
        .and_then(|()| match report_to.filter(|path| !is_stdout(path)) {
            None => Ok(()),
            Some(path) => files.writes(path, Role::Report, format!("--report {}", path.display())),
        })
        .map_err(Stop::refused)
}

fn write_report(
    path: &Path,
    text: &str,
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<(), Stop> {
    let text = plain_json(text) + "\n";
    let written = match is_stdout(path) {
        true => files.print(&text),
        false => files.write_text(path, &text, cancel),
    };
    written.map_err(|reason| Stop::unwritten(path, &reason, cancel))
}

/// Writes the report where nothing else is written. Told to stop, it is still written, but waited for no longer.
fn write_report_alone(
    path: &Path,
    text: &str,
    files: &mut Together,
    cancel: &CancelToken,
) -> Result<(), Stop> {
    write_report(path, text, files, &CancelToken::default())?;
    let placed = files.place(cancel);
    placed.map_err(|(path, why)| Stop::failed(format!("{}: {why}", path.display())))
}

/// Whether a path stands for standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}
