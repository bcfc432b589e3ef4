//! Conservation of energy over many steps, its balance, and the same bits on
//! any number of threads.

use crate::studies::motion::vibration::{Log, Vibration, vibrate};
use crate::studies::workbench::{Workbench, exact};
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::motion::energy::Energies;
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, BackgroundGrid, BodyForce, Dimension, Motion, Obstacle, Problem, StepControl,
};
use mtled_checks::measure::{larger, median};
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, Study, Table, axis, curve, line, number,
};
use mtled_run::machine::on_threads;
use mtled_run::run::integrate;
use mtled_run::specimens::simple::{SIZE, block_shape, bonded_face, free_body, recipe, tissue};

const THREADS: [usize; 5] = [1, 2, 3, 4, 8];
/// Steps of a vibration at half the critical step.
const STEPS: usize = 20_000;

/// Conservation, resonance, balance and repeatability.
pub(crate) fn energy(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    conservation(bench, study)?;
    resonance(bench, study)?;
    balance(bench, study)?;
    determinism(bench, study)
}

fn conservation(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let (mut drift, mut fluctuation, mut orders) = (0.0, 0.0, Vec::new());
    let mut rows = Vec::new();
    for seed in 0..bench.pick(3, 10) {
        let coarse = vibrate(STEPS, 0.5, bench.seed(seed))?;
        let fine = vibrate(2 * STEPS, 0.25, bench.seed(seed))?;
        let finished = coarse.survived == STEPS && fine.survived == 2 * STEPS;
        anyhow::ensure!(finished, "an undamped run at half the critical step failed");
        let order = (coarse.fluctuation() / fine.fluctuation()).log2();
        let numbers =
            [seed as f64, coarse.fluctuation(), fine.fluctuation(), order, coarse.drift()];
        rows.push(numbers.map(Cell::Number).to_vec());
        drift = larger(drift, coarse.drift());
        fluctuation = larger(fluctuation, coarse.fluctuation());
        orders.push(order);
        if seed == 0 {
            study.figures.push(Figure::Plot(vibration_figure(&coarse, &fine)));
        }
    }
    study.tables.push(Table {
        title: "Energy of an undamped vibration over its largest energy".into(),
        columns: vec![
            number("seed", "1"),
            number("fluctuation at 0.5 of the limit", "1"),
            number("fluctuation at 0.25", "1"),
            number("observed order", "1"),
            number("drift at 0.5", "1"),
        ],
        rows,
    });
    let order = median(&orders).unwrap_or(f64::NAN);
    conservation_checks(bench, study, [order, fluctuation, drift]);
    Ok(())
}

fn conservation_checks(
    bench: &Workbench,
    study: &mut Study,
    [order, fluctuation, drift]: [f64; 3],
) {
    study.checks.push(Check::new(
        "energy/vibration/order",
        "order in Δt of the fluctuation of the total energy",
        Kind::Exact,
        order,
        Bound::Between(1.7, 2.3),
        "1",
        "Central differences conserve an energy that differs from the total energy by O(Δt²)",
    ));
    study.checks.push(bench.regression(
        "energy/vibration/fluctuation",
        &format!(
            "standard deviation of the total energy in {STEPS} steps, over the largest energy"
        ),
        fluctuation,
        "1",
        "",
    ));
    study.checks.push(bench.regression(
        "energy/vibration/drift",
        &format!(
            "change of the mean energy from the first to the last quarter of {STEPS} steps, over \
             the largest energy"
        ),
        drift,
        "1",
        "the motion is chaotic, so that the last bits of a machine matter",
    ));
}

fn vibration_figure(coarse: &Vibration, fine: &Vibration) -> Plot {
    Plot {
        title: "Energy of an undamped vibration".into(),
        caption: "Change of the total energy over the largest energy, at two steps, for a block \
                  released from a stretch of 10 %. It fluctuates with Δt² and does not drift."
            .into(),
        x: axis("time", "s", false),
        y: axis("relative change", "1", false),
        series: vec![
            line("Δt at 0.5 of the limit", thin(&coarse.imbalance)),
            line("Δt at 0.25 of the limit", thin(&fine.imbalance)),
        ],
        slopes: Vec::new(),
    }
}

/// Every fourth sample: more cannot be seen.
fn thin(samples: &[(f64, f64)]) -> Vec<(f64, f64)> {
    samples.iter().step_by(4).copied().collect()
}

/// Below the linear limit a vibration of finite size may still diverge.
fn resonance(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    const MOST_STEPS: usize = 3000;
    const FRACTIONS: [f64; 7] = [0.6, 0.7, 0.8, 0.85, 0.875, 0.9, 0.95];
    let seeds = bench.pick(3, 10);
    let mut least_at_08 = MOST_STEPS;
    let (mut rows, mut least) = (Vec::new(), Vec::new());
    for fraction in FRACTIONS {
        let mut survived = Vec::new();
        for seed in 0..seeds {
            survived.push(vibrate(MOST_STEPS, fraction, bench.seed(seed))?.survived);
        }
        let shortest = survived.iter().copied().min().unwrap_or(0);
        let failed = survived.iter().filter(|steps| **steps < MOST_STEPS).count();
        if fraction <= 0.8 {
            least_at_08 = least_at_08.min(shortest);
        }
        rows.push(
            [fraction, failed as f64, seeds as f64, shortest as f64].map(Cell::Number).to_vec(),
        );
        least.push((fraction, shortest as f64));
    }
    study.tables.push(Table {
        title: "Undamped vibration of 10 % at steps near the limit".into(),
        columns: vec![
            number("step over the limit at rest", "1"),
            number("runs that failed", "1"),
            number("runs", "1"),
            number("shortest run in steps", "1"),
        ],
        rows,
    });
    study.figures.push(Figure::Plot(Plot {
        title: "Steps until an undamped vibration fails".into(),
        caption: format!("Steps until a point inverts, of {MOST_STEPS}; the shortest run."),
        x: axis("step over the limit at rest", "1", false),
        y: axis("steps survived", "1", false),
        series: vec![curve("shortest run", least)],
        slopes: Vec::new(),
    }));
    study.checks.push(bench.regression(
        "energy/resonance/survived",
        "steps survived by an undamped vibration of 10 % at up to 0.8 of the limit",
        least_at_08 as f64,
        "1",
        "none of 30 runs (ten clouds at 0.6, 0.7 and 0.8) has failed. Third-order resonance needs a \
         mode with ωΔt ≥ √3, so at least 0.866 of the limit (Skeel and Srinivas 2000), and the \
         limit falls by up to 5 % while the body moves",
    ));
    study.notes.push(
        "The limit 2/ω is valid for small motion. In an undamped vibration of finite amplitude a mode with \
         ωΔt = √3 advances by 120° in a step, and the quadratic part of its force then acts in phase \
         with it: of 40 runs between 0.85 and 0.95 of the limit, 13 fail, some within 250 steps, \
         although the limit of the tangent operator never falls below 0.95. A safety factor of 0.8 \
         avoids it. Vibrations of 2 % and the damped runs of this study at 0.9 have not shown it."
            .into(),
    );
    Ok(())
}

/// A bonded block under every kind of load at once.
fn loaded(seed: u64, end: f64) -> anyhow::Result<Problem> {
    let recipe = recipe(SIZE / 6.0, 0.3, seed);
    let mut problem = free_body(Dimension::Three, block_shape(), tissue(0.49)?, recipe);
    let smooth = Amplitude::Smooth { duration: 0.5 * end };
    problem.conditions = vec![
        bonded_face(2, 0.0, 0.0, Amplitude::Constant),
        bonded_face(2, SIZE, -0.1 * SIZE, smooth),
    ];
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: Vector3::new(9.81, 0.0, 0.0).into(),
        amplitude: Amplitude::Linear { duration: 0.5 * end },
    }];
    problem.obstacles = vec![Obstacle::new(
        "wall",
        Shape::HalfSpace { point: Vector3::x() * (1.03 * SIZE), normal: -Vector3::x() },
    )];
    problem.motion = Motion::Dynamic { end, step: StepControl::default(), damping: 5.0 };
    Ok(problem)
}

fn balance(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let mut worst = 0.0;
    for seed in 0..bench.pick(2, 10) {
        let problem = loaded(bench.seed(seed), 0.6)?;
        let mut log = Log::of_what_is_kept(2);
        integrate(Simulation::with_any_recipe(&problem)?, &mut log)?;
        anyhow::ensure!(log.touched > 0, "no node has touched the wall");
        let imbalance = log.imbalance().iter().map(|(_, e)| e.abs()).fold(0.0, larger);
        worst = larger(worst, imbalance);
        if seed == 0 {
            study.figures.push(Figure::Plot(balance_figure(&log)));
        }
    }
    study.checks.push(bench.regression(
        "energy/loaded/balance",
        "largest imbalance with prescribed motion, body force, damping and contact, over the \
         largest energy",
        worst,
        "1",
        "without what the mean of the strain energies of two steps has too much, as central \
         differences keep the rest of a linear body exactly",
    ));
    study.notes.push(
        "The work of prescribed motion and of contact is computed from the impulses that the \
         conditions add to the momentum, so the balance tests the internal forces against the \
         strain energy and the sum of all works, not the contact force itself."
            .into(),
    );
    Ok(())
}

fn balance_figure(log: &Log) -> Plot {
    let over_time = |of: fn(&Energies) -> f64| log.rows.iter().map(|(t, e)| (*t, of(e))).collect();
    Plot {
        title: "Energies of a loaded block".into(),
        caption: "Bonded block, pressed by 10 %, pushed sideways against a wall, damped.".into(),
        x: axis("time", "s", false),
        y: axis("energy", "J", false),
        series: vec![
            line("kinetic", over_time(|e| e.kinetic)),
            line("strain", over_time(|e| e.strain)),
            line("work of body force", over_time(|e| e.external_work)),
            line("work of conditions and contact", over_time(|e| e.constraint_work)),
            line("damping loss", over_time(|e| e.damping_loss)),
            line("balance", over_time(|e| e.balance())),
        ],
        slopes: Vec::new(),
    }
}

/// The same final displacements, bit for bit, on any number of threads.
fn determinism(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let mut problem = loaded(bench.seed(0), 0.2)?;
    problem.recipe = recipe(SIZE / 10.0, 0.3, bench.seed(0));
    problem.recipe.grid = BackgroundGrid::with_cell(SIZE / 20.0);
    let (blocks, alone) = final_bits(&problem, 1)?;
    anyhow::ensure!(blocks > 4, "{blocks} blocks are too few to show a dependence on threads");
    for threads in THREADS {
        let (_, bits) = final_bits(&problem, threads)?;
        let differing = alone.iter().zip(&bits).filter(|(a, b)| a != b).count();
        study.checks.push(exact(
            &format!("energy/threads/{threads}"),
            &format!(
                "displacement components that differ on {threads} threads from a first run on one"
            ),
            differing as f64,
            0.0,
            "Blocks do not depend on the threads and are summed in a fixed order",
        ));
    }
    Ok(())
}

/// Bits of the final displacements after a short run, and the number of blocks.
fn final_bits(problem: &Problem, threads: usize) -> anyhow::Result<(usize, Vec<u64>)> {
    on_threads(threads, || {
        let simulation = Simulation::with_any_recipe(problem)?;
        let blocks = simulation.model.points.blocks.len();
        let solved = integrate(simulation, &mut Unobserved)?;
        let bits = solved.simulation.state.displacement.iter().map(|u| u.to_bits()).collect();
        Ok((blocks, bits))
    })?
}
