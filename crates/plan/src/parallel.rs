//! The same work for many things, on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// What came of each, in their order, whatever the number of threads. After an error nothing new is begun; of several
/// the one of the first thing is told.
pub fn each<T: Send, R: Send, E: Send>(
    threads: usize,
    things: impl IntoIterator<Item = T, IntoIter: Send>,
    work: impl Fn(T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    if threads <= 1 {
        return things.into_iter().map(work).collect();
    }
    let (queue, failed) = (Mutex::new(things.into_iter().enumerate()), AtomicBool::new(false));
    let (send, receive) = mpsc::channel();
    let mut done: Vec<(usize, Result<R, E>)> = std::thread::scope(|scope| {
        for _ in 0..threads {
            let (send, queue, failed, work) = (send.clone(), &queue, &failed, &work);
            scope.spawn(move || {
                // The lock is held for no more than one step of the list.
                let next = || queue.lock().ok()?.next();
                while let Some((index, thing)) = next() {
                    let result = work(thing);
                    let ends = result.is_err();
                    if send.send((index, result)).is_err() || ends {
                        failed.store(true, Ordering::Relaxed);
                    }
                    if failed.load(Ordering::Relaxed) {
                        break;
                    }
                }
            });
        }
        drop(send);
        receive.iter().collect()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn results_come_in_order_whatever_the_number_of_threads() {
        for threads in [0, 1, 2, 7, 300] {
            let squares: Result<Vec<u64>, ()> = each(threads, 0..200, |i: u64| Ok(i * i));
            assert_eq!(squares, Ok((0..200).map(|i| i * i).collect()));
            assert_eq!(each(threads, std::iter::empty::<u8>(), Err::<(), u8>), Ok(Vec::new()));
        }
    }

    #[test]
    fn the_first_error_is_told_and_ends_the_work() {
        for threads in [1, 2, 5] {
            let begun = AtomicUsize::new(0);
            let result = each(threads, 0..10_000, |i| {
                begun.fetch_add(1, Ordering::Relaxed);
                if i % 10 == 3 { Err(i) } else { Ok(i) }
            });
            assert_eq!(result, Err(3), "{threads} threads");
            assert!(begun.into_inner() < 10_000, "{threads} threads");
        }
    }

    /// What is worked on may be borrowed, and changed.
    #[test]
    fn borrows_what_it_works_on() {
        let mut numbers = vec![1, 2, 3];
        let sum: Result<Vec<()>, ()> = each(2, numbers.iter_mut(), |n| {
            *n *= 10;
            Ok(())
        });
        assert!(sum.is_ok());
        assert_eq!(numbers, [10, 20, 30]);
    }
}
