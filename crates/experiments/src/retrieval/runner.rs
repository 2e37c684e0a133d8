//! Many runs, several at once.

use crate::retrieval::experiment::Case;
use crate::retrieval::row::Row;
use crate::retrieval::run::{Bench, NoRow};
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::mpsc;

/// Runs all cases on `jobs` threads, in their order; `each` gets every row as it is there. Ends at the first
/// error, its own included.
pub fn run_all<E: From<NoRow>>(
    bench: &Bench,
    cases: &[Case],
    jobs: usize,
    mut each: impl FnMut(Row) -> Result<(), E>,
) -> Result<(), E> {
    let mut left = HashMap::new();
    for case in cases {
        *left.entry(case.draw).or_insert(0_usize) += 1;
    }
    let queue = Mutex::new(cases.iter());
    let (send, receive) = mpsc::sync_channel(jobs);
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            let (send, queue) = (send.clone(), &queue);
            scope.spawn(move || {
                // The lock is held for no more than one step of the list.
                let next = || queue.lock().ok()?.next();
                while let Some(case) = next() {
                    // Nobody listens any more when there was an error.
                    if send.send((case.draw, bench.run(case))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        for (draw, row) in receive {
            each(row?)?;
            if let Some(left) = left.get_mut(&draw) {
                *left -= 1;
                if *left == 0 {
                    bench.done_with(&draw);
                }
            }
        }
        Ok(())
    })
}
