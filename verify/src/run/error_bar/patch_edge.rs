//! Prescribed surfaces that end between nodes.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;
use mtled::discretisation::neighbours::Neighbours;
use mtled::discretisation::nodes::NodeCloud;
use mtled::geometry::Extent;
use mtled::problem::Problem;

/// Distance of neighbours on the surface over their spacing \[–\].
const REACH: f64 = 1.5;
/// Distance from a held node, over that to its neighbour, beyond which a surface that is
/// still held there ends between them \[–\].
const BETWEEN: f64 = 0.05;

/// The name of the first condition on a surface whose edge lies between nodes: what is
/// held there depends on the cloud, by up to half a spacing all around. A surface that ends
/// at an edge of the body, or at nodes, is not one.
pub fn edge_between_nodes(problem: &Problem, cloud: &NodeCloud) -> Option<String> {
    let boundary: Vec<usize> =
        (0..cloud.positions.len()).filter(|&node| cloud.on_boundary[node]).collect();
    let positions: Vec<Vector3> = boundary.iter().map(|&node| cloud.positions[node]).collect();
    let largest = cloud.spacing.iter().copied().fold(0.0, f64::max);
    if positions.is_empty() {
        return None;
    }
    let neighbours = Neighbours::new(&positions, REACH * largest);
    let surfaces = problem.conditions.iter().filter(|c| c.extent == Extent::Surface);
    let ends_between = |part: &mtled::geometry::Selector| {
        boundary.iter().filter(|&&node| part.contains(&cloud.positions[node])).any(|&node| {
            let X = cloud.positions[node];
            let mut found = false;
            neighbours.for_each_within(&X, REACH * cloud.spacing[node], |_, offset| {
                let free = !part.contains(&(X + offset));
                found |= free && part.contains(&(X + offset * BETWEEN));
            });
            found
        })
    };
    surfaces.into_iter().find(|c| ends_between(&c.part)).map(|c| c.name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::prepare;
    use crate::scene::read_case;

    #[test]
    fn held_caps_and_discs_end_between_nodes_and_whole_faces_and_arcs_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let cases = crate::bundled::unpack(folder.path()).unwrap();
        for (name, edge) in [
            ("sphere_gravity", Some("cap")),
            ("indented_block", Some("disc")),
            ("cube_compression", None),
            ("twisted_cylinder", None),
            ("turek_hron_csm1", None),
            ("cook_membrane", None),
        ] {
            let problem = read_case(&cases.join(format!("{name}.toml"))).unwrap().problem;
            let cloud = prepare(&problem).unwrap().discretisation.cloud;
            assert_eq!(edge_between_nodes(&problem, &cloud).as_deref(), edge, "{name}");
        }
    }
}
