//! How much may be spent: a deadline, a cap on iterations, threads; and a flag that cancels.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Why work stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    Deadline,
    Iterations,
    Cancelled,
}

/// Shared by every loop of one planning request; clones count together.
#[derive(Clone, Debug, Default)]
pub struct Budget {
    deadline: Option<Instant>,
    iterations: Option<u64>,
    spent: Arc<AtomicU64>,
    cancelled: Arc<AtomicBool>,
    /// Besides the first.
    more_threads: usize,
}

impl Budget {
    pub fn unlimited() -> Self {
        Self::default()
    }

    #[must_use]
    pub fn with_time(mut self, limit: Duration) -> Self {
        self.deadline = Instant::now().checked_add(limit);
        self
    }

    /// At most this many iterations of the planner's outer loop (Algorithm 1, line 6).
    #[must_use]
    pub fn with_iterations(mut self, limit: u64) -> Self {
        self.iterations = Some(limit);
        self
    }

    /// Stops whatever runs under this budget when the flag becomes true.
    #[must_use]
    pub fn with_cancel(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancelled = flag;
        self
    }

    /// So many threads may be used at once; without this, one.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.more_threads = threads.saturating_sub(1);
        self
    }

    pub fn threads(&self) -> usize {
        self.more_threads + 1
    }

    /// The same flag and iterations, but all the time in the world.
    #[must_use]
    pub fn without_deadline(&self) -> Self {
        Self { deadline: None, ..self.clone() }
    }

    /// Counts one iteration, and says whether it may be run.
    pub fn iteration(&self) -> Result<(), Stop> {
        self.check()?;
        let before = self.spent.fetch_add(1, Ordering::Relaxed);
        if self.iterations.is_some_and(|limit| before >= limit) { Err(Stop::Iterations) } else { Ok(()) }
    }

    /// How much time is left; `None`: all there is.
    pub fn remaining(&self) -> Option<Duration> {
        self.deadline.map(|d| d.saturating_duration_since(Instant::now()))
    }

    /// Says whether work may go on. Cheap enough for inner loops (tens of nanoseconds).
    pub fn check(&self) -> Result<(), Stop> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Stop::Cancelled);
        }
        if self.deadline.is_some_and(|d| Instant::now() >= d) {
            return Err(Stop::Deadline);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_for_each_reason() {
        let budget = Budget::unlimited().with_iterations(2);
        assert_eq!((budget.iteration(), budget.clone().iteration()), (Ok(()), Ok(())));
        assert_eq!(budget.iteration(), Err(Stop::Iterations));
        assert_eq!(Budget::unlimited().with_time(Duration::ZERO).check(), Err(Stop::Deadline));
        let flag = Arc::new(AtomicBool::new(false));
        let budget = Budget::unlimited().with_cancel(flag.clone());
        assert_eq!(budget.check(), Ok(()));
        flag.store(true, Ordering::Relaxed);
        assert_eq!(budget.check(), Err(Stop::Cancelled));
    }
}
