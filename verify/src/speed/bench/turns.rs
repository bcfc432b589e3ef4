//! Pieces of work timed in turns, so that their ratios are of the same minute.

use crate::machine::cpu_seconds;
use mtled_checks::measure::median;
use std::time::Instant;

/// What is read before and after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Of the wall, for work on several threads.
    Wall,
    /// Processor time of this process, for work on one thread while all others
    /// sleep: other programs take nothing from it but caches and bandwidth.
    Processor,
}

/// A piece of work.
pub type Piece<'a> = &'a mut (dyn FnMut() + Send);

/// Seconds of some work.
pub fn seconds_of(clock: Clock, work: impl FnOnce()) -> f64 {
    let (wall, processor) = (Instant::now(), cpu_seconds());
    work();
    match clock {
        Clock::Wall => wall.elapsed().as_secs_f64(),
        Clock::Processor => cpu_seconds() - processor,
    }
}

/// Seconds per call \[round\]\[piece\].
pub struct Turns {
    seconds: Vec<Vec<f64>>,
}

/// A sample is at least so long \[s\], by repeating the call.
const SAMPLE: f64 = 2e-3;

/// Times every piece once per round. A sample starts with an untimed call,
/// which brings back to the caches what the other pieces have put out.
pub fn in_turns(clock: Clock, rounds: usize, pieces: &mut [Piece]) -> Turns {
    let calls: Vec<usize> = pieces
        .iter_mut()
        .map(|piece| {
            piece();
            (SAMPLE / seconds_of(clock, &mut **piece).max(1e-9)).clamp(1.0, 1e6).ceil() as usize
        })
        .collect();
    let mut round = || -> Vec<f64> {
        let sample = |(piece, &calls): (&mut Piece, &usize)| {
            piece();
            seconds_of(clock, || (0..calls).for_each(|_| piece())) / calls as f64
        };
        pieces.iter_mut().zip(&calls).map(sample).collect()
    };
    Turns { seconds: (0..rounds).map(|_| round()).collect() }
}

impl Turns {
    /// Median seconds per call of a piece.
    pub fn median(&self, piece: usize) -> f64 {
        self.middle(|round| round[piece])
    }

    /// Median over the rounds of the time of one piece over that of another.
    pub fn ratio(&self, piece: usize, other: usize) -> f64 {
        self.middle(|round| round[piece] / round[other])
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
    fn ratios_are_of_the_same_round() {
        let seconds = vec![vec![1.0, 2.0], vec![10.0, 20.0], vec![3.0, 9.0]];
        let turns = Turns { seconds };
        assert_eq!(turns.median(0), 3.0);
        assert_eq!(turns.ratio(1, 0), 2.0);
    }

    #[test]
    fn short_work_is_repeated_until_it_can_be_timed() {
        let mut calls = 0;
        let turns = in_turns(Clock::Wall, 3, &mut [&mut || calls += 1]);
        assert!(calls > 100, "{calls}");
        assert!(turns.median(0) > 0.0);
    }
}
