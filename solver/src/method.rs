#![doc = include_str!("../docs/rustdoc_links.md")]
#![doc = include_str!("../docs/method.md")]

/// A chapter. Of two links with one name the first counts: here that to a module, in the file alone
/// that to another file.
macro_rules! chapter {
    ($name:ident, $file:tt) => {
        #[doc = include_str!("../docs/rustdoc_links.md")]
        #[doc = include_str!($file)]
        pub mod $name {}
    };
}

chapter!(symbols, "../docs/method/symbols.md");
chapter!(kinematics, "../docs/method/01_kinematics.md");
chapter!(materials, "../docs/method/03_materials.md");
chapter!(bodies_and_nodes, "../docs/method/04_bodies_and_nodes.md");
chapter!(moving_least_squares, "../docs/method/06_moving_least_squares.md");
chapter!(quadrature, "../docs/method/07_quadrature.md");
chapter!(consistent_gradients, "../docs/method/09_consistent_gradients.md");
chapter!(forces, "../docs/method/10_forces.md");
chapter!(loads_and_conditions, "../docs/method/14_loads_and_conditions.md");
chapter!(dynamics, "../docs/method/17_dynamics.md");
chapter!(statics, "../docs/method/20_statics.md");
chapter!(checks_and_answers, "../docs/method/22_checks_and_answers.md");
chapter!(experience, "../docs/method/24_experience.md");
chapter!(equations, "../docs/method/27_equations.md");
