//! Sessions on several cores, with their results in order.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

use proprio_session::Progress;

use crate::error::Error;
use crate::progress_bar::{Bar, JoinedBar};

/// Works on sessions, as many at a time as there are cores, and passes the results to `take` in the order of the sessions, up to
/// the first error. After an error no further session starts.
pub fn each_in_order<T: Send>(
    work: &str,
    sessions: &[PathBuf],
    run: impl Fn(&PathBuf, &mut dyn Progress) -> Result<T, Error> + Sync,
    mut take: impl FnMut(&PathBuf, T),
) -> Result<(), Error> {
    if let [session] = sessions {
        take(session, run(session, &mut Bar::new())?);
        return Ok(());
    }
    let (next, bar) = (AtomicUsize::new(0), Mutex::new(JoinedBar::new(work, sessions.len())));
    let threads = thread::available_parallelism().map_or(1, usize::from).min(sessions.len());
    thread::scope(|scope| {
        let (sender, results) = channel();
        for _ in 0..threads {
            let (sender, run, next, bar) = (sender.clone(), &run, &next, &bar);
            scope.spawn(move || {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(session) = sessions.get(i) else { break };
                    let result = run(session, &mut JoinedBar::part(bar, i));
                    if result.is_err() {
                        next.store(sessions.len(), Ordering::Relaxed);
                    }
                    if sender.send((i, result)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut waiting: Vec<Option<Result<T, Error>>> = sessions.iter().map(|_| None).collect();
        let mut taken = 0;
        for (i, result) in results {
            waiting[i] = Some(result);
            while let Some(result) = waiting.get_mut(taken).and_then(Option::take) {
                let result = result?;
                bar.lock().unwrap_or_else(std::sync::PoisonError::into_inner).hidden(|| take(&sessions[taken], result));
                taken += 1;
            }
        }
        Ok(())
    })
}
