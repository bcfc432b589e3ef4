//! What studies work with: the suite, the clouds of a run, and the bundled cases.

use crate::reference::{ReferenceError, ReferenceFile, read_reference};
use crate::run::{Record, Solved, solve_case};
use crate::scene::{Case, one_error, read_case};
use anyhow::{Result, bail};
use mtled::problem::{Cloud, Problem};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// How thorough the studies are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suite {
    Quick,
    Full,
}

/// Seeds of one run do not meet those of the next.
const SEEDS_APART: u64 = 1000;
/// Jitter of the lattices of carried cases with another seed \[spacing\].
const VARIATION: f64 = 0.02;

/// What the studies work with.
#[derive(Debug)]
pub struct Workbench {
    pub suite: Suite,
    /// Which family of clouds: 0 is the one that all stated figures belong to.
    seed: u64,
    cases: PathBuf,
}

impl Workbench {
    /// Unpacks the carried cases into the output folder.
    pub fn new(suite: Suite, seed: u64, out: &Path) -> Result<Workbench> {
        Ok(Workbench { suite, seed, cases: crate::bundled::unpack(out)? })
    }

    /// The seed of a random cloud in this run, for one that is stated.
    pub fn seed(&self, stated: u64) -> u64 {
        stated + SEEDS_APART * self.seed
    }

    /// Gives a jittered or graded cloud the seed of this run.
    pub fn reseed(&self, problem: &mut Problem) {
        if let Cloud::Jittered { seed, .. } | Cloud::Graded { seed, .. } = &mut problem.recipe.cloud
        {
            *seed = self.seed(*seed);
        }
    }

    /// A carried case; with another seed on a cloud that differs a little.
    pub fn case(&self, name: &str) -> Result<Case> {
        let mut case = self.stated_case(name)?;
        if self.seed > 0 {
            self.vary(&mut case.problem);
        }
        Ok(case)
    }

    /// A lattice jittered by [`VARIATION`] of its spacing, a graded cloud moved in
    /// its tree of lattices.
    fn vary(&self, problem: &mut Problem) {
        if let Cloud::Regular { spacing } = problem.recipe.cloud {
            let (jitter, seed) = (VARIATION, 0);
            problem.recipe.cloud = Cloud::Jittered { spacing, jitter, seed };
        }
        self.reseed(problem);
    }

    /// A carried case on the very cloud of its file.
    pub fn stated_case(&self, name: &str) -> Result<Case> {
        read_case(&self.cases.join(format!("{name}.toml"))).map_err(one_error)
    }

    /// The carried reference of a case.
    pub fn reference(&self, case: &Case) -> Result<ReferenceFile, ReferenceError> {
        let absent = || ReferenceError::Absent { case: case.name.clone() };
        let text = crate::bundled::carried_reference(&case.name).ok_or_else(absent)?;
        read_reference(case, text)
    }

    /// One of two values, by suite.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        match self.suite {
            Suite::Quick => quick,
            Suite::Full => full,
        }
    }
}

/// |computed − truth|/|truth| \[–\].
pub fn relative_error(computed: f64, truth: f64) -> f64 {
    (computed - truth).abs() / truth.abs()
}

/// Node spacing \[m\] of a recipe; for a graded cloud the largest.
pub fn spacing_of(problem: &Problem) -> Result<f64> {
    match problem.recipe.cloud {
        Cloud::Regular { spacing }
        | Cloud::Jittered { spacing, .. }
        | Cloud::Graded { spacing, .. } => Ok(spacing),
        Cloud::Given { .. } => bail!("nodes that are given have no spacing to change"),
    }
}

/// The same case with every length of its recipe scaled to another spacing \[m\].
pub fn respaced(case: &Case, spacing: f64) -> Result<Case> {
    let factor = spacing / spacing_of(&case.problem)?;
    let mut case = case.clone();
    let recipe = &mut case.problem.recipe;
    match &mut recipe.cloud {
        Cloud::Regular { spacing } | Cloud::Jittered { spacing, .. } => *spacing *= factor,
        Cloud::Graded { spacing, refinements, .. } => {
            *spacing *= factor;
            refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
        }
        Cloud::Given { .. } => {}
    }
    let grid = &mut recipe.grid;
    grid.cell *= factor;
    grid.boundary_cell = grid.boundary_cell.map(|cell| cell * factor);
    grid.refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
    Ok(case)
}

/// A case solved at several spacings \[m\], side by side.
pub fn solve_ladder(case: &Case, spacings: &[f64]) -> Result<Vec<(f64, Solved, Record)>> {
    let run = |&spacing: &f64| {
        let (solved, record) = solve_case(&respaced(case, spacing)?)?;
        Ok((spacing, solved, record))
    };
    spacings.par_iter().map(run).collect()
}
