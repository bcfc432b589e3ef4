//! How far the solver may be from the references.

use mtled_run::accuracy::Group;

/// Largest difference over the largest value of its group, without the reference's error bar \[–\].
pub(crate) const TARGET: f64 = 0.02;

/// Cases whose load bends or twists them: only there are reaction moments compared.
const MOMENTS: [&str; 5] =
    ["cook_membrane", "parted_arms", "turek_hron_csm1", "turek_hron_csm2", "twisted_cylinder"];

/// Groups of a case with a wider limit \[–\], or without comparison.
type Groups = &'static [(Group, Option<f64>)];

/// Cases with such groups, and the reason.
const EXCEPTIONS: &[(&str, Groups, &str)] = &[
    (
        "brain_gravity",
        &[(Group::StrainEnergy, Some(0.05))],
        "weight above the level of the fluid is given to whole quadrature points: 2.6 % too much with 5 000 \
         nodes, 1 % too little with 20 000, and the energy is quadratic in it (4 and 1 % off)",
    ),
    (
        "brain_shift",
        &[(Group::Force, None), (Group::StrainEnergy, Some(0.05))],
        "the brain all but floats in its skull: the force that holds it is 0.009 to 0.019 N in the references, \
         and the place of the skull changes it by 0.02 N per 0.1 mm; their energies differ by 4 %",
    ),
    (
        "brain_slice",
        &[(Group::Force, None), (Group::StrainEnergy, None), (Group::CentreOfMass, Some(0.025))],
        "voxel edges on the outline change how the brain slides along the skull: the finite-element centres \
         by 0.03 to 0.05 mm, 1 to 2 % of their displacement, which is not in their error bar",
    ),
    (
        "falling_beam",
        &[(Group::Force, Some(0.026))],
        "the reaction of an undamped body oscillates with the scheme",
    ),
    (
        "sphere_gravity",
        &[
            (Group::Displacement, Some(0.06)),
            (Group::CentreOfMass, Some(0.065)),
            (Group::StrainEnergy, Some(0.06)),
        ],
        "the cap has a radius of 3.5 spacings, and on a lattice the ball also leans sideways, which the \
         reference does not: the top sinks 2.5 % too far and moves aside by 3 % of that. With 0.7 and 0.5 \
         times the spacing it sinks 0.4 % too far and 0.1 % too little",
    ),
    (
        "turek_hron_csm3",
        &[(Group::Force, None)],
        "the reaction of the reference has an error bar of 14 %",
    ),
];

/// The limit of a group of a case \[–\] and the reason where it is not [`TARGET`]; None where the
/// group is not compared.
pub(crate) fn limit(case: &str, group: Group) -> Option<(f64, &'static str)> {
    let of_case = EXCEPTIONS.iter().find(|(name, ..)| *name == case);
    let exception = of_case.and_then(|(_, groups, reason)| {
        let (_, limit) = groups.iter().find(|(other, _)| *other == group)?;
        Some(limit.map(|limit| (limit, *reason)))
    });
    let compared = match group {
        Group::KineticEnergy => false,
        Group::Moment => MOMENTS.contains(&case),
        _ => true,
    };
    exception.unwrap_or_else(|| compared.then_some((TARGET, "")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled_case::bundled::CASES;

    #[test]
    fn exceptions_are_of_bundled_cases_and_above_the_target() {
        let bundled = |case: &str| CASES.iter().any(|(name, _)| *name == case);
        assert!(MOMENTS.iter().all(|case| bundled(case)));
        for (case, groups, reason) in EXCEPTIONS {
            let wide = groups.iter().all(|(_, limit)| limit.is_none_or(|limit| limit > TARGET));
            assert!(bundled(case) && wide && !reason.is_empty(), "{case}");
        }
    }

    #[test]
    fn every_other_group_has_the_target() {
        assert_eq!(limit("falling_beam", Group::Force).map(|(limit, _)| limit), Some(0.026));
        assert_eq!(limit("falling_beam", Group::Displacement), Some((TARGET, "")));
        assert_eq!(limit("brain_slice", Group::Force), None);
        assert_eq!(limit("uniaxial_bar", Group::Moment), None);
    }
}
