//! Sensitivities of the answers of a case to its numbers.

use super::answers::{Asked, AskedError, NoAnswer, asked};
use super::numbers::{Number, numbers};
use crate::lab::store::Source;
use mtled::Answer;
use mtled::Simulation;
use mtled::audit::Audit;
use mtled::error::Error;
use mtled::motion::observe::Unobserved;
use mtled::problem::{Friction, Motion, Obstacle, Problem};
use mtled_case::scene::{Case, Diagnostic, NotAnOverride, Override, parse_overridden};
use mtled_run::machine::cpu_seconds;
use mtled_run::run::{interrupted, located};
use std::path::Path;

/// A sensitivity below this part of its answer per part of the number is one of none \[–\].
const NONE: f64 = 1e-9;
/// Where a check compares a sensitivity with one of none, this part of the answer per part of the
/// number is what both are compared with \[–\].
const SMALLEST: f64 = 1e-2;

/// How the answers of a case change with its numbers.
#[derive(Debug)]
pub struct Sensitivities {
    /// The case.
    pub case: Case,
    /// Name, unit and value of each answer.
    pub answers: Vec<(String, &'static str, f64)>,
    /// The numbers that change something, those that matter most first.
    pub rows: Vec<Row>,
    /// Keys of the numbers that change nothing.
    pub without_effect: Vec<String>,
    /// Names of the answers that are 0 up to round-off.
    pub nothing: Vec<String>,
    /// What was asked beside what the run has done.
    pub audit: Audit,
    /// Reasons to doubt the solution.
    pub doubts: Vec<String>,
    /// CPU time of the run, with its set-up \[s\].
    pub run_cpu_s: f64,
    /// CPU time of the adjoints and of the numbers \[s\].
    pub sensitivities_cpu_s: f64,
}

/// A number with its sensitivities.
#[derive(Debug)]
pub struct Row {
    /// Key and value.
    pub number: Number,
    /// dJ/dp \[answer\], in the units of the case file.
    pub derivatives: Vec<f64>,
    /// (p/J) dJ/dp \[answer\] \[–\]: per cent per per cent.
    pub relative: Vec<f64>,
    /// The same by differences of solutions on both sides of the number, where that was asked
    /// for \[answer\] \[–\].
    pub by_solutions: Option<Vec<f64>>,
}

impl Row {
    /// From the changes of the answers across two steps of the number, and their `values`.
    fn new(number: Number, change: Vec<f64>, values: &[f64]) -> Row {
        let slope = |change: f64| change / (2.0 * number.step());
        let derivatives: Vec<f64> = change.into_iter().map(slope).collect();
        let per_part = |(slope, value): (&f64, &f64)| slope * number.value / value;
        let relative = derivatives.iter().zip(values).map(per_part).collect();
        Row { number, derivatives, relative, by_solutions: None }
    }

    /// The largest sensitivity \[–\].
    fn size(&self) -> f64 {
        self.relative.iter().fold(0.0, |most, size| most.max(size.abs()))
    }

    fn has_effect(&self) -> bool {
        !self.relative.iter().all(|size| size.abs() < NONE)
    }

    /// The largest difference of the two over the sensitivity \[–\].
    pub fn difference(&self) -> Option<f64> {
        let by_solutions = self.by_solutions.as_ref()?;
        let differences = self
            .relative
            .iter()
            .zip(by_solutions)
            .map(|(own, other)| (own - other).abs() / own.abs().max(other.abs()).max(SMALLEST));
        Some(differences.fold(0.0, f64::max))
    }
}

/// Why there are no sensitivities.
#[derive(Debug, thiserror::Error)]
pub enum Unmeasured {
    /// Mistakes in the case file.
    #[error("{}", .0.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n"))]
    Case(Vec<Diagnostic>),
    /// A name of the command line.
    #[error(transparent)]
    Answer(#[from] NoAnswer),
    /// A number that cannot be written.
    #[error(transparent)]
    Number(#[from] NotAnOverride),
    /// The user.
    #[error("stopped")]
    Stopped,
}

/// Solves a static case and finds the sensitivities of the answers that `names` name. Where
/// `checks`, it is solved again on both sides of each number. `notify` is called before every
/// part of this.
pub fn measure(
    source: &Source,
    names: &[String],
    checks: bool,
    notify: &dyn Fn(&str),
) -> Result<Sensitivities, Unmeasured> {
    let mut case = source.case.clone();
    by_newton(&mut case)?;
    let of_solver = |error: Error| Unmeasured::Case(vec![located(&source.case, &error)]);
    notify("the case");
    let cpu = cpu_seconds();
    let (simulation, doubts) = solve(&case.problem).map_err(of_solver)?;
    let run_cpu_s = cpu_seconds() - cpu;
    let audit = simulation.audit().map_err(of_solver)?;
    let cpu = cpu_seconds();
    let values = |answers: &[Answer]| Ok(simulation.adjoint(answers)?.values());
    let chosen = asked(&case, &simulation, names, &values).map_err(|error| match error {
        AskedError::Name(name) => Unmeasured::Answer(name),
        AskedError::Solver(error) => of_solver(error),
    })?;
    let (chosen, nothing): (Vec<Asked>, Vec<Asked>) =
        chosen.into_iter().partition(|asked| !asked.is_nothing);
    let values: Vec<f64> = chosen.iter().map(|asked| asked.value).collect();
    let questions: Vec<Answer> = chosen.iter().map(|asked| asked.answer.clone()).collect();
    let mut adjoint = simulation.adjoint(&questions).map_err(of_solver)?;
    let mut rows = Vec::new();
    for number in numbers(&case) {
        if interrupted() {
            return Err(Unmeasured::Stopped);
        }
        notify(&number.key);
        let [below, above] = sides(source, &number)?;
        let change = adjoint.change(&below, &above).map_err(of_solver)?;
        rows.push(Row::new(number, change, &values));
    }
    let (mut rows, without): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(Row::has_effect);
    let without_effect = without.into_iter().map(|row| row.number.key).collect();
    let sensitivities_cpu_s = cpu_seconds() - cpu;
    for row in rows.iter_mut().filter(|_| checks) {
        notify(&format!("{}, by solutions on both sides", row.number.key));
        row.by_solutions = Some(by_solutions(source, &questions, &values, row, &of_solver)?);
    }
    rows.sort_by(|a, b| b.size().total_cmp(&a.size()));
    let answer = |(own, value): (Asked, f64)| (own.name, own.unit, value);
    Ok(Sensitivities {
        case,
        answers: chosen.into_iter().zip(values).map(answer).collect(),
        rows,
        without_effect,
        nothing: nothing.into_iter().map(|asked| asked.name).collect(),
        audit,
        doubts,
        run_cpu_s,
        sensitivities_cpu_s,
    })
}

/// Newton's method in place of relaxation; refuses motions, and obstacles that hold.
fn by_newton(case: &mut Case) -> Result<(), Unmeasured> {
    if let Motion::Relaxed(relaxation) = case.problem.motion {
        case.problem.motion = Motion::Static(relaxation);
    }
    let holds = |obstacle: &Obstacle| obstacle.friction != Friction::Frictionless;
    let (key, reason) = if let Motion::Dynamic { .. } = case.problem.motion {
        let reason = "is \"dynamic\"; sensitivities are those of a static solution: set time = { method = \"static\" }";
        ("time.method".to_string(), reason)
    } else if let Some(index) = case.problem.obstacles.iter().position(holds) {
        let reason = "is not \"frictionless\": a solution then depends on the way to it; sensitivities are those of one \
                      that does not, with friction = \"frictionless\"";
        (format!("obstacle[{index}].friction"), reason)
    } else {
        return Ok(());
    };
    Err(Unmeasured::Case(vec![case.diagnostic(&key, reason.into())]))
}

/// A solved problem, with the reasons to doubt it.
fn solve(problem: &Problem) -> Result<(Simulation, Vec<String>), Error> {
    let mut simulation = Simulation::new(problem)?;
    let mut doubts: Vec<String> = simulation.warnings().iter().map(ToString::to_string).collect();
    let summary = simulation.run(&mut Unobserved)?;
    doubts.extend(simulation.doubts(&summary));
    Ok((simulation, doubts))
}

/// The problem on both sides of a number.
fn sides(source: &Source, number: &Number) -> Result<[Problem; 2], Unmeasured> {
    let side = |by: f64| -> Result<Problem, Unmeasured> {
        let moved = number.moved(by)?;
        let mut case = with(source, &[moved])?;
        by_newton(&mut case)?;
        Ok(case.problem)
    };
    Ok([side(-number.step())?, side(number.step())?])
}

fn with(source: &Source, changes: &[Override]) -> Result<Case, Unmeasured> {
    let folder = source.file.parent().unwrap_or(Path::new("."));
    let file = source.file.display().to_string();
    parse_overridden(source.case.text(), &file, folder, changes).map_err(Unmeasured::Case)
}

/// The sensitivities of a number by central differences of solutions.
fn by_solutions(
    source: &Source,
    questions: &[Answer],
    values: &[f64],
    row: &Row,
    of_solver: &dyn Fn(Error) -> Unmeasured,
) -> Result<Vec<f64>, Unmeasured> {
    let value = |problem: &Problem| Ok(solve(problem)?.0.adjoint(questions)?.values());
    let [below, above] = sides(source, &row.number)?;
    let (below, above) = (value(&below).map_err(of_solver)?, value(&above).map_err(of_solver)?);
    let scale = row.number.value / (2.0 * row.number.step());
    let slope = |((above, below), value): ((&f64, &f64), &f64)| scale * (above - below) / value;
    Ok(above.iter().zip(&below).zip(values).map(slope).collect())
}
