//! The library alone and the program give the same answer.

use mtled::motion::observe::Unobserved;
use mtled::simulation::Simulation;
use mtled_case::bundled::unpack;
use mtled_case::scene::read_case;
use mtled_run::run::solve_case;

#[test]
fn a_problem_through_the_library_has_the_bits_that_the_program_gives() {
    let folder = tempfile::tempdir().unwrap();
    let cases = unpack(folder.path()).unwrap();
    for name in ["cube_compression", "uniaxial_bar", "cook_membrane"] {
        let case = read_case(&cases.join(format!("{name}.toml"))).unwrap();
        let (solved, _) = solve_case(&case).unwrap();
        let mut simulation = Simulation::new(&case.problem).unwrap();
        let summary = simulation.run(&mut Unobserved).unwrap();
        assert_eq!(summary, solved.summary, "{name}");
        let bits = |u: &[f64]| u.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(
            bits(&simulation.state.displacement),
            bits(&solved.state.displacement),
            "{name}"
        );
    }
}
