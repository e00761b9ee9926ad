//! Asking for a file: the system's own dialog on a thread of its own, behind a trait so that tests can answer.
//!
//! The window never waits for a dialog. Where the system has none to show (no portal answers), that is told and the
//! browser of this program is used instead ([`super::browser`]).

use crate::core::documents::Purpose;
use crate::jobs::render::files::Format as Pictures;
use crate::scene::lights::Surroundings;
use coif_nodes::formats::export::Format;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::task::{Context, Poll, Wake};
use std::thread::Thread;

impl Purpose {
    /// What the dialog says on top.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a groom",
            Self::Compare => "Compare with a groom",
            Self::Mesh => "Choose a head",
            Self::NewHead => "Choose the head of a new groom",
            Self::Find => "Find the missing file",
            Self::Save => "Save the groom as",
            Self::Export => "Export hair as",
            Self::Picture => "Save a picture as",
            Self::Surroundings => "Choose surroundings",
        }
    }
    /// Whether the file may be new.
    pub(crate) fn saves(self) -> bool {
        matches!(self, Self::Save | Self::Export | Self::Picture)
    }
    /// What the files are called, and how their names end. The first is taken where somebody writes no ending.
    pub(crate) fn endings(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Open | Self::Compare | Self::Save => ("Grooms", &["ron"]),
            Self::Mesh | Self::NewHead | Self::Find => ("Meshes", MESHES),
            Self::Export => ("Hair", HAIR),
            Self::Picture => ("Pictures", PICTURES),
            Self::Surroundings => ("Surroundings", Surroundings::ENDINGS),
        }
    }
    /// A chosen path with an ending that fits.
    pub(crate) fn complete(self, path: PathBuf) -> PathBuf {
        let (_, endings) = self.endings();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match endings.first() {
            Some(first) if self.saves() && !ending.is_some_and(|e| endings.contains(&&*e)) => {
                let mut whole = path.into_os_string();
                whole.push(".");
                whole.push(first);
                whole.into()
            }
            _ => path,
        }
    }
}

/// Meshes that the head node reads.
pub(crate) const MESHES: &[&str] = coif_nodes::formats::mesh_in::EXTENSIONS;
/// What files of hair and of pictures end in: those that jobs write, in their order.
const HAIR: &[&str] = &endings(Format::ALL);
const PICTURES: &[&str] = &endings(Pictures::ALL);

/// The endings of a list of formats.
const fn endings<F: Copy, const N: usize>(all: [(&'static str, F); N]) -> [&'static str; N] {
    let (mut endings, mut at) = ([""; N], 0);
    while at < N {
        endings[at] = all[at].0;
        at += 1;
    }
    endings
}

/// A question for a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Question {
    /// What for.
    pub(crate) purpose: Purpose,
    /// Where to begin.
    pub(crate) folder: PathBuf,
    /// The name that is offered where something is saved.
    pub(crate) name: String,
}

/// What became of a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Somebody chose.
    Chosen(PathBuf),
    /// Somebody closed the dialog.
    Nothing,
    /// There is no dialog to show.
    NoDialog,
}

/// Something that asks people for files. One question at a time.
pub(crate) trait Dialogs {
    /// Asks; returns at once. An older question is dropped.
    fn ask(&mut self, question: &Question);
    /// The answer, once there is one.
    fn answer(&mut self) -> Option<Answer>;
    /// The window has lost the keyboard: to a dialog, where one was asked for.
    fn lost_keyboard(&mut self) {}
}

/// The system's own dialogs.
pub(crate) struct System {
    wake: Arc<dyn Fn() + Send + Sync>,
    waiting: Option<Receiver<Answer>>,
    /// Whether the window has lost the keyboard since the question: a dialog that takes none was never there, however long it took to
    /// find that out.
    seen: bool,
}

impl System {
    /// Dialogs that call `wake` when they are answered.
    pub(crate) fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { wake, waiting: None, seen: false }
    }
}

impl Dialogs for System {
    fn ask(&mut self, question: &Question) {
        let (send, receive) = channel();
        (self.waiting, self.seen) = (Some(receive), false);
        let (name, endings) = question.purpose.endings();
        let mut dialog = rfd::AsyncFileDialog::new()
            .set_title(question.purpose.title())
            .add_filter(name, endings);
        if question.folder.is_dir() {
            dialog = dialog.set_directory(&question.folder);
        }
        let wake = self.wake.clone();
        let saves = question.purpose.saves();
        if saves {
            dialog = dialog.set_file_name(&question.name);
        }
        // Some systems want dialogs made on the thread of the window, and all may wait elsewhere.
        type Chosen = std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>>;
        let chosen: Chosen =
            if saves { Box::pin(dialog.save_file()) } else { Box::pin(dialog.pick_file()) };
        let spawned = std::thread::Builder::new().name("file dialog".to_owned()).spawn(move || {
            let answer = match wait(chosen) {
                Some(file) => Answer::Chosen(file.path().to_owned()),
                None => Answer::Nothing,
            };
            // Nobody waits any more when another question was asked meanwhile.
            let _ = send.send(answer);
            wake();
        });
        if spawned.is_err() {
            self.waiting = None;
        }
    }

    fn answer(&mut self) -> Option<Answer> {
        let answer = match self.waiting.as_ref()?.try_recv() {
            Ok(Answer::Nothing) if !self.seen => Answer::NoDialog,
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Answer::NoDialog,
        };
        self.waiting = None;
        Some(answer)
    }

    fn lost_keyboard(&mut self) {
        self.seen = true;
    }
}

/// Waits on this thread for something.
fn wait<T>(mut future: std::pin::Pin<Box<dyn Future<Output = T> + Send>>) -> T {
    struct Unpark(Thread);
    impl Wake for Unpark {
        fn wake(self: Arc<Self>) {
            self.0.unpark();
        }
    }
    let waker = Arc::new(Unpark(std::thread::current())).into();
    let mut cx = Context::from_waker(&waker);
    loop {
        match future.as_mut().poll(&mut cx) {
            Poll::Ready(out) => return out,
            Poll::Pending => std::thread::park(),
        }
    }
}

#[cfg(test)]
pub(crate) mod fake {
    use super::*;
    use std::sync::Mutex;

    /// Answers that were laid out before, and the questions that were asked.
    #[derive(Clone, Default)]
    pub(crate) struct Fake {
        pub(crate) answers: Arc<Mutex<Vec<Answer>>>,
        pub(crate) asked: Arc<Mutex<Vec<Question>>>,
        waits: bool,
    }

    impl Fake {
        pub(crate) fn answers(&self, answer: Answer) {
            self.answers.lock().unwrap().push(answer);
        }
    }

    impl Dialogs for Fake {
        fn ask(&mut self, question: &Question) {
            self.asked.lock().unwrap().push(question.clone());
            self.waits = true;
        }
        fn answer(&mut self) -> Option<Answer> {
            let mut answers = self.answers.lock().unwrap();
            let waits = std::mem::take(&mut self.waits);
            (waits && !answers.is_empty()).then(|| answers.remove(0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_the_ending_that_fits() {
        let check = |purpose: Purpose, given: &str, whole: &str| {
            assert_eq!(purpose.complete(given.into()), PathBuf::from(whole));
        };
        check(Purpose::Save, "/a/front rows", "/a/front rows.ron");
        check(Purpose::Save, "/a/v1.2", "/a/v1.2.ron");
        check(Purpose::Save, "/a/x.RON", "/a/x.RON");
        check(Purpose::Export, "/a/x", "/a/x.usdc");
        check(Purpose::Export, "/a/x.hair", "/a/x.hair");
        check(Purpose::Export, "/a/x.abc", "/a/x.abc");
        check(Purpose::Open, "/a/x", "/a/x");
    }

    #[test]
    fn a_dialog_that_never_took_the_keyboard_was_never_there() {
        for seen in [false, true] {
            let mut system = System::new(Arc::new(|| {}));
            let (send, receive) = channel();
            system.waiting = Some(receive);
            assert_eq!(system.answer(), None);
            if seen {
                system.lost_keyboard();
            }
            send.send(Answer::Nothing).unwrap();
            let expected = if seen { Answer::Nothing } else { Answer::NoDialog };
            assert_eq!((system.answer(), system.answer()), (Some(expected), None));
        }
    }

    #[test]
    fn endings_of_exports_are_those_that_can_be_written() {
        assert!(HAIR.iter().all(|ending| Format::of_extension(ending).is_some()));
        assert_eq!(Format::EXTENSIONS.matches('.').count(), HAIR.len());
    }
}
