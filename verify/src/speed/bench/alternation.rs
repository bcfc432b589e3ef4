//! Work timed alternately, so that ratios compare times of the same minute.

use crate::machine::cpu_seconds;
use mtled_checks::measure::median;
use std::time::Instant;

/// The clock that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Wall time, for work on several threads.
    Wall,
    /// CPU time of this process, for work on one thread while all others sleep: other programs
    /// disturb it through caches and bandwidth only.
    Processor,
}

/// Work that is timed.
pub type Work<'a> = &'a mut (dyn FnMut() + Send);

/// Time of one call \[s\].
pub fn seconds_of(clock: Clock, work: impl FnOnce()) -> f64 {
    let (wall, processor) = (Instant::now(), cpu_seconds());
    work();
    match clock {
        Clock::Wall => wall.elapsed().as_secs_f64(),
        Clock::Processor => cpu_seconds() - processor,
    }
}

/// Times per call \[s\].
pub struct Alternation {
    /// \[round\]\[work\]
    seconds: Vec<Vec<f64>>,
}

/// Shortest sample \[s\]; shorter calls are repeated.
const SAMPLE: f64 = 2e-3;

/// Calls whose fastest gives the time of one call: a program that interrupts one or two of them does
/// not make samples short.
const TRIALS: usize = 5;

/// Number of calls in a sample of work that took these times \[s\].
fn calls_per_sample(trials: impl IntoIterator<Item = f64>) -> usize {
    let fastest = trials.into_iter().fold(f64::INFINITY, f64::min);
    (SAMPLE / fastest.max(1e-9)).clamp(1.0, 1e6).ceil() as usize
}

/// Times each of several pieces of work once per round. A sample starts with an untimed call, which
/// fills the caches again.
pub fn alternate(clock: Clock, rounds: usize, works: &mut [Work]) -> Alternation {
    let calls: Vec<usize> = works
        .iter_mut()
        .map(|work| calls_per_sample((0..=TRIALS).map(|_| seconds_of(clock, &mut **work)).skip(1)))
        .collect();
    let mut round = || -> Vec<f64> {
        let sample = |(work, &calls): (&mut Work, &usize)| {
            work();
            seconds_of(clock, || (0..calls).for_each(|_| work())) / calls as f64
        };
        works.iter_mut().zip(&calls).map(sample).collect()
    };
    Alternation { seconds: (0..rounds).map(|_| round()).collect() }
}

impl Alternation {
    /// Median time per call of a piece of work \[s\].
    pub fn median(&self, work: usize) -> f64 {
        self.middle(|round| round[work])
    }

    /// Median over the rounds of the time of one piece of work over that of another \[–\].
    pub fn ratio(&self, work: usize, other: usize) -> f64 {
        self.middle(|round| round[work] / round[other])
    }

    fn middle(&self, value: impl Fn(&[f64]) -> f64) -> f64 {
        let values: Vec<f64> = self.seconds.iter().map(|round| value(round)).collect();
        median(&values).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_compare_times_of_the_same_round() {
        let seconds = vec![vec![1.0, 2.0], vec![10.0, 20.0], vec![3.0, 9.0]];
        let times = Alternation { seconds };
        assert_eq!(times.median(0), 3.0);
        assert_eq!(times.ratio(1, 0), 2.0);
    }

    #[test]
    fn short_work_is_repeated_until_it_can_be_timed() {
        assert_eq!(calls_per_sample([1e-5, 1e-5]), 200);
        assert_eq!(calls_per_sample([3e-3, 1e-5]), 200, "an interrupted trial does not count");
        assert_eq!(calls_per_sample([0.5]), 1);
        assert_eq!(calls_per_sample([0.0]), 1_000_000);
    }

    #[test]
    fn work_is_called_for_its_trials_and_twice_or_more_in_every_round() {
        let mut calls = 0;
        let times = alternate(Clock::Wall, 3, &mut [&mut || calls += 1]);
        assert!(calls >= 1 + TRIALS + 3 * 2, "{calls}");
        assert!(times.median(0).is_finite());
    }
}
