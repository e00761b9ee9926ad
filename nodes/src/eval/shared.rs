//! What a node makes beside pieces of hair: many things at once, one thing as a whole, or a list replayed.
//!
//! Guarantees: results come in order, and the same whatever was kept; where somebody asks to stop, nothing half made is given or kept.

use super::{EvalCx, Kept};
use crate::error::NodeError;
use crate::maths::hash::{Key, KeyBuilder};
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};

impl EvalCx<'_> {
    /// What `make` gives for 0 to `n`, in order, made on all threads. The first failure counts.
    pub fn map<T: Send + Sync>(
        &self,
        n: usize,
        make: impl Fn(usize) -> Result<T, NodeError> + Sync,
    ) -> Result<Vec<T>, NodeError> {
        let made: Vec<OnceLock<Result<T, NodeError>>> = (0..n).map(|_| OnceLock::new()).collect();
        self.host.for_each(n, &|i| {
            if !self.host.cancelled() {
                let _ = made[i].set(make(i));
            }
        });
        made.into_iter().map(|one| one.into_inner().unwrap_or(Err(NodeError::Cancelled))).collect()
    }

    /// A node's work in one piece, of so many bytes. It reads the node's values, what `read` is the key of, and nothing else that varies.
    pub fn whole<T: Send + Sync + 'static>(
        &self,
        read: Key,
        make: impl FnOnce() -> Result<(T, usize), NodeError>,
    ) -> Result<Arc<T>, NodeError> {
        let key = KeyBuilder::new("whole").key(self.node).key(read).finish();
        let (made, ran) = self.kept(key, make)?;
        let count = if ran { &self.log.tufts_run } else { &self.log.tufts_reused };
        count.fetch_add(1, Ordering::Relaxed);
        Ok(made)
    }

    /// Something of so many bytes derived from `key` alone that several evaluations may share, such as a tree over roots.
    pub fn memo<T: Send + Sync + 'static>(
        &self,
        key: Key,
        make: impl FnOnce() -> Result<(T, usize), NodeError>,
    ) -> Result<Arc<T>, NodeError> {
        Ok(self.kept(KeyBuilder::new("memo").key(key).finish(), make)?.0)
    }

    /// What is kept under a key, or made and kept; and whether it was made.
    fn kept<T: Send + Sync + 'static>(
        &self,
        key: Key,
        make: impl FnOnce() -> Result<(T, usize), NodeError>,
    ) -> Result<(Arc<T>, bool), NodeError> {
        if let Some(found) = self.found(key) {
            return Ok((found, false));
        }
        let (value, bytes) = make()?;
        let value = Arc::new(value);
        self.host.keep(key, value.clone(), bytes);
        Ok((value, true))
    }

    fn found<T: Send + Sync + 'static>(&self, key: Key) -> Option<Arc<T>> {
        self.host.find(key).and_then(|kept: Kept| kept.downcast().ok())
    }

    /// A list replayed on a state. The states after every item are kept, so that adding to the end runs one step
    /// and changing an item runs from there on.
    pub fn fold<S: Send + Sync + 'static, I>(
        &self,
        start: (Key, impl FnOnce() -> Result<S, NodeError>),
        items: &[(Key, I)],
        step: impl Fn(&S, &I) -> Result<S, NodeError>,
        bytes: impl Fn(&S) -> usize,
    ) -> Result<Arc<S>, NodeError> {
        let mut keys = vec![KeyBuilder::new("fold").key(self.node).key(start.0).finish()];
        for (key, _) in items {
            let last = keys[keys.len() - 1];
            keys.push(KeyBuilder::new("fold").key(last).key(*key).finish());
        }
        let known = (0..keys.len()).rev().find_map(|i| Some((i, self.found(keys[i])?)));
        let (mut done, mut state) = match known {
            Some(known) => known,
            None => {
                let state = Arc::new(start.1()?);
                self.host.keep(keys[0], state.clone(), bytes(&state));
                (0, state)
            }
        };
        self.log.tufts_reused.fetch_add(done as u32, Ordering::Relaxed);
        while done < items.len() {
            self.check()?;
            state = Arc::new(step(&state, &items[done].1)?);
            self.log.tufts_run.fetch_add(1, Ordering::Relaxed);
            done += 1;
            self.host.keep(keys[done], state.clone(), bytes(&state));
        }
        Ok(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::{Host, Log, PlainHost, Quality};
    use crate::testing::{Memory, Threads};
    use std::sync::atomic::AtomicBool;

    #[test]
    fn a_map_gives_results_in_order_on_any_threads_and_the_first_failure() {
        let log = Log::default();
        for host in [&PlainHost as &dyn Host, &Threads(3)] {
            let cx = EvalCx::new(0, Quality::Final, Key(1), host, &log);
            assert_eq!(cx.map(100, |i| Ok(i * i)), Ok((0..100).map(|i| i * i).collect()));
            assert_eq!(cx.map(0, Ok), Ok(vec![]));
            let fails =
                |i: usize| if i > 4 { Err(NodeError::failed(i.to_string())) } else { Ok(i) };
            assert_eq!(cx.map(9, fails), Err(NodeError::failed("5")));
        }
    }

    /// A host that is asked to stop once something runs.
    #[derive(Default)]
    struct Stops(Memory, AtomicBool);

    impl Host for Stops {
        fn for_each(&self, n: usize, f: &(dyn Fn(usize) + Sync)) {
            self.0.for_each(n, f);
        }
        fn cancelled(&self) -> bool {
            self.1.load(Ordering::Relaxed)
        }
        fn find(&self, key: Key) -> Option<Kept> {
            self.0.find(key)
        }
        fn keep(&self, key: Key, value: Kept, bytes: usize) {
            self.0.keep(key, value, bytes);
        }
    }

    #[test]
    fn nothing_half_made_is_given_or_kept() {
        let (host, log) = (Stops::default(), Log::default());
        let cx = EvalCx::new(0, Quality::Final, Key(1), &host, &log);
        let squares = || {
            let made = cx.map(10, |i| {
                host.1.store(i == 3, Ordering::Relaxed);
                Ok(i * i)
            })?;
            Ok((made, 80))
        };
        assert_eq!(cx.whole(Key(2), squares), Err(NodeError::Cancelled));
        assert_eq!(cx.memo(Key(2), squares), Err(NodeError::Cancelled));
        host.1.store(false, Ordering::Relaxed);
        let made = || Ok((vec![7usize], 8));
        assert_eq!(*cx.whole(Key(2), made).unwrap(), [7]);
        assert_eq!(*cx.whole(Key(2), squares).unwrap(), [7], "known");
        assert_eq!(*cx.memo(Key(2), || Ok((8u32, 4))).unwrap(), 8, "another kind of thing");
        let other = EvalCx::new(0, Quality::Final, Key(9), &host, &log);
        assert_eq!(*other.memo(Key(2), || Ok((9u32, 4))).unwrap(), 8, "shared by nodes");
        assert_eq!(*other.whole(Key(2), || Ok((vec![9usize], 8))).unwrap(), [9], "the node's own");
        let count = [&log.tufts_run, &log.tufts_reused].map(|n| n.load(Ordering::Relaxed));
        assert_eq!(count, [2, 1], "what is shared is no piece of a node");
    }
}
